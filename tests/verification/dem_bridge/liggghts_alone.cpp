/// LIGGGHTS by itself: runs the commands of a file, without the bridge. For tests that compare the two.
#include <mpi.h>

#include <liggghts/lammps.h>

#include <liggghts/input.h>

#include <fstream>
#include <iostream>
#include <string>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: liggghts_alone COMMANDS\n";
    return 2;
  }
  MPI_Init(&argc, &argv);
  {
    std::string words[] = {"liggghts", "-log", "none", "-nocite", "-screen", "none"};
    char* pointers[] = {words[0].data(), words[1].data(), words[2].data(),
                        words[3].data(), words[4].data(), words[5].data()};
    LAMMPS_NS::LAMMPS lammps(6, pointers, MPI_COMM_WORLD);
    std::ifstream file(argv[1]);
    for (std::string line; std::getline(file, line);) lammps.input->one(line.c_str());
  }
  MPI_Finalize();
  return 0;
}
