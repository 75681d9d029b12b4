/// liggghts_host ENDPOINT DRIVER: LIGGGHTS behind the wire. Started by tuft (never by hand) with the shared
/// memory as descriptor 3; answers one request at a time until told to quit or until the driver, process
/// DRIVER, is gone.
#include <mpi.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <iostream>
#include <stdexcept>
#include <string>
#include <zmq.hpp>

#include "dem_bridge/host/liggghts_engine.h"
#include "dem_bridge/protocol.h"
#include "dem_bridge/shared_memory.h"

namespace {

using namespace tuft::dem;

constexpr int shared_memory_descriptor = 3;
constexpr long receive_timeout = 1000;  // ms, after which the driver is looked for

/// Waits for the next request; false when the driver is gone.
bool receive(zmq::socket_t& socket, int driver_watch, pid_t driver, std::string& message) {
  while (true) {
    zmq_pollitem_t watched[] = {{socket.handle(), 0, ZMQ_POLLIN, 0}, {nullptr, driver_watch, ZMQ_POLLIN, 0}};
    if (zmq_poll(watched, driver_watch >= 0 ? 2 : 1, receive_timeout) < 0 && zmq_errno() != EINTR)
      return false;
    zmq::message_t received;
    if (socket.recv(received, zmq::recv_flags::dontwait)) {
      message = received.to_string();
      return true;
    }
    if (watched[1].revents != 0 || ::getppid() != driver) return false;
  }
}

/// What the answer is to carry.
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
    case Request::energy:
      engine.compute_stored_energy();
      return {};
    case Request::contacts:
      engine.compute_contacts();
      return {};
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

int run(const std::string& endpoint, pid_t driver) {
  SharedMemory memory = SharedMemory::open(shared_memory_descriptor);
  const int driver_watch = static_cast<int>(::syscall(SYS_pidfd_open, driver, 0));
  zmq::context_t context{1};
  zmq::socket_t socket{context, zmq::socket_type::pair};
  socket.set(zmq::sockopt::linger, 200);
  socket.connect(endpoint);
  LiggghtsEngine engine(memory);
  std::string message;
  while (receive(socket, driver_watch, driver, message)) {
    if (message.empty()) continue;
    const auto request = static_cast<Request>(message[0]);
    std::string answer(1, static_cast<char>(Answer::done));
    try {
      answer += serve(engine, request, message.substr(1));
    } catch (const std::exception& error) {
      answer = static_cast<char>(Answer::failed) + std::string(error.what());
    }
    socket.send(zmq::buffer(answer), zmq::send_flags::none);
    if (request == Request::quit) break;
  }
  return EXIT_SUCCESS;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 3) {
    std::cerr << "liggghts_host is started by tuft; usage: liggghts_host ENDPOINT DRIVER\n";
    return 2;
  }
  const auto driver = static_cast<pid_t>(std::strtol(arguments[2], nullptr, 10));
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != driver) return EXIT_FAILURE;  // it died before the line above
  MPI_Init(nullptr, nullptr);
  int status = EXIT_FAILURE;
  try {
    status = run(arguments[1], driver);
  } catch (const std::exception& error) {
    std::cerr << "ERROR: " << error.what() << '\n';
  }
  MPI_Finalize();
  return status;
}
