/// LIGGGHTS by itself, without the bridge, for what compares the two: runs the commands of a file, or of its
/// standard input. Each of those is answered by a line: seconds of wall time and of processor time it took.
#include <mpi.h>
#include <time.h>

#include <liggghts/lammps.h>

#include <liggghts/input.h>

#include <fstream>
#include <iostream>
#include <string>

namespace {

double seconds(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void run_commands(LAMMPS_NS::LAMMPS& lammps, std::istream& commands, bool answering) {
  for (std::string line; std::getline(commands, line);) {
    const double wall = seconds(CLOCK_MONOTONIC), processor = seconds(CLOCK_PROCESS_CPUTIME_ID);
    lammps.input->one(line.c_str());
    if (answering)
      std::cout << seconds(CLOCK_MONOTONIC) - wall << ' ' << seconds(CLOCK_PROCESS_CPUTIME_ID) - processor
                << std::endl;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 2) {
    std::cerr << "usage: liggghts_alone [COMMANDS]\n";
    return 2;
  }
  MPI_Init(&argc, &argv);
  {
    std::string words[] = {"liggghts", "-log", "none", "-nocite", "-screen", "none"};
    char* pointers[] = {words[0].data(), words[1].data(), words[2].data(),
                        words[3].data(), words[4].data(), words[5].data()};
    LAMMPS_NS::LAMMPS lammps(6, pointers, MPI_COMM_WORLD);
    if (argc == 2) {
      std::ifstream file(argv[1]);
      run_commands(lammps, file, false);
    } else {
      run_commands(lammps, std::cin, true);
    }
  }
  MPI_Finalize();
  return 0;
}
