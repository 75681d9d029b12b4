#pragma once
/// One measured figure of speed, as written to the JSON of `tuft.sh bench`.
#include <map>
#include <string>

namespace tuft::bench {

struct Figure {
  double value = 0;
  std::string unit;
  int threads = 1;
};

/// "sph_paper/2" -> figure. The suffix is the number of threads.
using Figures = std::map<std::string, Figure>;

}  // namespace tuft::bench
