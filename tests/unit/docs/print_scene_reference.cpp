#include <cstdio>

#include "scene_reference_page.h"

int main() {
  std::fputs(tuft::scene_reference_page().c_str(), stdout);
}
