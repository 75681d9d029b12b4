#include "rigs/strip_failure.h"

namespace tuft::rigs {
namespace {

template <class Carpet>
bool any_eroded(const Carpet& carpet) {
  if constexpr (requires { carpet.eroded_count(); })
    return carpet.eroded_count() > 0;
  else
    return false;
}

}  // namespace

bool strip_failed(const fe::Carpet& carpet) {
  return any_eroded(carpet);
}

}  // namespace tuft::rigs
