#include "coupler/contact_pairs.h"

namespace tuft::coupler {

std::vector<ContactHistory> carry_over(const std::vector<PairKey>& old_keys,
                                       const std::vector<ContactHistory>& old_histories,
                                       const std::vector<PairKey>& new_keys) {
  std::vector<ContactHistory> result(new_keys.size());
  std::size_t old = 0;
  for (std::size_t i = 0; i < new_keys.size(); ++i) {
    while (old < old_keys.size() && old_keys[old] < new_keys[i]) ++old;
    if (old < old_keys.size() && old_keys[old] == new_keys[i]) result[i] = old_histories[old];
  }
  return result;
}

}  // namespace tuft::coupler
