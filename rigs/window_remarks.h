#pragma once
/// What makes coupling windows shorter than a scene asks for, or than they could be.
#include <string>

#include "core/scene.h"
#include "coupler/step_plan.h"

namespace tuft::rigs {

/// One line; empty where there is nothing worth saying: windows are as asked for (numerics.coupling_window),
/// or, where none are, nearly as long as is stable. interval: s, from one row to the next, which whole
/// numbers of windows make up; `rows` says what they are rows of ("output.histories"), in a scene's words
/// where it has any.
[[nodiscard]] std::string remark_on_windows(const coupler::StableSteps& stable, const Numerics& numerics,
                                            double interval, const std::string& rows);

}  // namespace tuft::rigs
