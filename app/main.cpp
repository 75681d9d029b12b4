#include "app/command_line.h"
#include "app/short_waits.h"

int main(int count, char** arguments) {
  tuft::app::shorten_waits(arguments);
  return tuft::app::run_command_line(count, arguments);
}
