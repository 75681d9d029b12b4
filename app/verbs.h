#pragma once
/// One function a verb: describes its arguments to the parser and stores what to do.
#include "app/command_line.h"

namespace tuft::app {

void register_run(CLI::App& program, Action& action);
void register_resume(CLI::App& program, Action& action);
void register_check(CLI::App& program, Action& action);
void register_explain(CLI::App& program, Action& action);
void register_carpet(CLI::App& program, Action& action);
void register_compare(CLI::App& program, Action& action);
void register_calibrate(CLI::App& program, Action& action);
void register_point(CLI::App& program, Action& action);
void register_report(CLI::App& program, Action& action);
void register_micro(CLI::App& program, Action& action);
void register_show(CLI::App& program, Action& action);

}  // namespace tuft::app
