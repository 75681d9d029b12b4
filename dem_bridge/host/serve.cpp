#include "dem_bridge/host/serve.h"

#include <stdexcept>

#include "dem_bridge/protocol.h"

namespace tuft::dem {
namespace {

std::string serve(LiggghtsEngine& engine, Request request, const std::string& text) {
  switch (request) {
    case Request::hello:
    case Request::quit:
      return {};
    case Request::commands:
      engine.set_up(text);
      return {};
    case Request::advance:
      engine.advance();
      return {};
    case Request::census:
      engine.take_census();
      return {};
    case Request::energy:
      engine.compute_stored_energy();
      return {};
    case Request::contacts:
      return engine.list_overlaps();
    case Request::network:
      return engine.list_contacts();
    case Request::save:
      engine.save(text);
      return {};
    case Request::resume:
      engine.resume();
      return {};
  }
  throw std::runtime_error("unknown request");
}

}  // namespace

std::string answer_to(LiggghtsEngine& engine, const std::string& message) {
  try {
    return static_cast<char>(Answer::done) +
           serve(engine, static_cast<Request>(message.at(0)), message.substr(1));
  } catch (const std::exception& error) {
    return static_cast<char>(Answer::failed) + std::string(error.what());
  }
}

}  // namespace tuft::dem
