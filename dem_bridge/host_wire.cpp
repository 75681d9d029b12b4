#include "dem_bridge/host_wire.h"

#include "core/error.h"
#include "dem_bridge/protocol.h"

namespace tuft::dem {

std::string tell_end(HostWire& wire) {
  const std::string ending = wire.how_it_went(), words = wire.last_words();
  return fmt::format("liggghts_host {}{}", ending, words.empty() ? "" : "; its last words: " + words);
}

std::string join_answers(const std::vector<std::string>& answers) {
  std::string all(1, static_cast<char>(Answer::done));
  for (const std::string& answer : answers) {
    if (answer.empty() && answers.size() > 1) continue;  // another one has failed
    if (answer.empty() || answer[0] != static_cast<char>(Answer::done))
      return static_cast<char>(Answer::failed) +
             (answer.size() > 1 ? answer.substr(1) : "liggghts_host gave an unknown answer");
    all.append(answer, 1);
  }
  return all;
}

}  // namespace tuft::dem
