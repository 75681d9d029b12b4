/// So many steps of one case of the shells' field and nothing else, for tools that count what a step executes
/// (count_instructions.py): shell_step CASE STEPS, with CASE 0 to 4 as in fibre_field.h. Prints the number of
/// element-steps.
#include <cstdlib>
#include <iostream>

#include "bench/fibre_field.h"
#include "core/parallel.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "shell_step CASE STEPS, with CASE 0 to " << tuft::bench::field_cases - 1 << "\n";
    return 2;
  }
  tuft::set_threads(1);
  const auto of = tuft::bench::field_case(std::atoi(argv[1]));
  const auto carpet = tuft::bench::swinging_field(of);
  tuft::Vec3Array load;
  load.assign(carpet->nodes().x.size(), 0.0);
  const double dt = tuft::bench::field_step_safety * carpet->stable_step();
  for (int i = 0; i < std::atoi(argv[2]); ++i) carpet->step(dt, load);
  std::cout << of.name << " " << carpet->element_steps() << "\n";
}
