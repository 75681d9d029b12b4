#include "dem_bridge/host_link.h"

#include "core/error.h"
#include "dem_bridge/last_words.h"

namespace tuft::dem {
namespace {

using Clock = HostWire::Clock;

Clock::time_point deadline_in(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace

HostLink::HostLink(const DemOptions& options, std::size_t grains)
    : timeout_(options.answer_timeout),
      wire_(options.host.starts_with("tcp://") ? reach_remote_host(options, grains)
                                               : start_local_host(options, grains, deadline_in(timeout_))) {
  ask(Request::hello, {}, "starting liggghts_host");
}

HostLink::~HostLink() {
  const char quit = static_cast<char>(Request::quit);
  if (failure_.empty()) wire_->quit({&quit, 1});
}

void HostLink::fail(std::string message) {
  failure_ = std::move(message);
  wire_->kill();
  throw RunError(failure_);
}

std::string HostLink::ask(Request request, std::string_view text, std::string_view doing) {
  if (!failure_.empty()) throw RunError(failure_);
  std::string message(1, static_cast<char>(request));
  message += text;
  std::vector<std::string> answers;
  switch (wire_->exchange(message, deadline_in(timeout_), answers)) {
    case HostWire::Outcome::answered:
      break;
    case HostWire::Outcome::silent: {
      const std::string error = error_line(wire_->last_words());
      fail(fmt::format("{}: liggghts_host did not answer for {} s {}{}", doing, timeout_, wire_->why_silent(),
                       error.empty() ? "" : "; its last words: " + error));
    }
    case HostWire::Outcome::gone:
      fail(fmt::format("{}: {}", doing, tell_end(*wire_)));
  }
  const std::string all = join_answers(answers);
  if (all[0] != static_cast<char>(Answer::done)) fail(fmt::format("{}: {}", doing, all.substr(1)));
  return all.substr(1);
}

}  // namespace tuft::dem
