/// LIGGGHTS behind the wire. Answers one request at a time until told to quit or until the driver is gone.
///   liggghts_host --driver PROCESS --socket PATH   started by tuft; given the shared memory at the socket;
///                                                  under mpirun each rank has its own connection
///   liggghts_host --listen tcp://*:PORT [--once] [--frozen-after SECONDS]
///                                                  started by hand, for drivers on other machines
///   liggghts_host --serve tcp://*:PORT PROCESS     started by --listen, process PROCESS, for one driver
#include <mpi.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "dem_bridge/host/liggghts_engine.h"
#include "dem_bridge/host/listen.h"
#include "dem_bridge/host/serve.h"
#include "dem_bridge/message_socket.h"
#include "dem_bridge/protocol.h"
#include "dem_bridge/shared_memory.h"

namespace {

using namespace tuft::dem;

/// Ends this process when who started it ends, whatever LIGGGHTS is at. (For a child the kernel does so at
/// once; a rank is a child of mpirun.)
void end_with(pid_t starter) {
  const int watch = static_cast<int>(::syscall(SYS_pidfd_open, starter, 0));
  if (watch < 0) {
    if (errno != ESRCH)  // else it is gone already
      std::cerr << "ERROR: liggghts_host cannot watch the process that started it: " << std::strerror(errno)
                << "; raise the limit of open files (ulimit -n)\n";
    ::_exit(EXIT_FAILURE);
  }
  std::thread([watch] {
    pollfd ended{watch, POLLIN, 0};
    while (::poll(&ended, 1, -1) < 0) {
    }
    ::_exit(EXIT_FAILURE);
  }).detach();
}

/// Waits for the next request; false when the driver is gone.
bool receive(MessageSocket& socket, std::string& message) {
  while (true) {
    if (auto received = socket.receive()) {
      message = std::move(*received);
      return true;
    }
    if (socket.closed()) return false;
    pollfd watched{socket.descriptor(), POLLIN, 0};
    ::poll(&watched, 1, -1);
  }
}

int run(const std::string& path) {
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MessageSocket socket = connect_to(path);
  socket.send(std::to_string(rank));
  SharedMemory memory = SharedMemory::open(socket.receive_descriptor());
  LiggghtsEngine engine(memory, rank);
  std::string message;
  while (receive(socket, message)) {
    if (message.empty()) continue;
    socket.send(answer_to(engine, message));
    if (message[0] == static_cast<char>(Request::quit)) break;
  }
  return EXIT_SUCCESS;
}

struct Listening {
  std::string endpoint;
  bool once = false;
  double frozen_after = 60;  ///< s
};

/// What --listen was asked for; empty where these are not its words.
std::optional<Listening> listening(const std::vector<std::string>& words) {
  if (words.size() < 2 || words[0] != "--listen") return std::nullopt;
  Listening asked{words[1]};
  for (std::size_t k = 2; k < words.size(); ++k) {
    if (words[k] == "--once") {
      asked.once = true;
    } else if (words[k] == "--frozen-after" && k + 1 < words.size()) {
      char* end = nullptr;
      asked.frozen_after = std::strtod(words[++k].c_str(), &end);
      if (*end != '\0' || !(asked.frozen_after >= 1)) return std::nullopt;
    } else {
      return std::nullopt;
    }
  }
  return asked;
}

}  // namespace

int main(int count, char** arguments) {
  const std::vector<std::string> words(arguments + 1, arguments + count);
  const std::string mode = words.empty() ? "" : words[0];
  if (const auto asked = listening(words)) try {
      return listen_for_drivers(asked->endpoint, asked->once, asked->frozen_after);
    } catch (const std::exception& error) {
      std::cerr << "ERROR: " << error.what() << '\n';
      return EXIT_FAILURE;
    }
  const bool serves = mode == "--serve" && words.size() == 3;
  if (!serves && !(mode == "--driver" && words.size() == 4 && words[2] == "--socket")) {
    std::cerr << "liggghts_host is started by tuft; by hand for another machine: liggghts_host --listen "
                 "tcp://*:PORT [--once] [--frozen-after SECONDS]\n";
    return 2;
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  end_with(static_cast<pid_t>(std::strtol(words[serves ? 2 : 1].c_str(), nullptr, 10)));
  if (serves) try {
      return serve_one_driver(words[1]);
    } catch (const std::exception& error) {
      std::cerr << "ERROR: " << error.what() << '\n';
      return cannot_listen;
    }
  MPI_Init(nullptr, nullptr);
  int status = EXIT_FAILURE;
  try {
    status = run(words[3]);
  } catch (const std::exception& error) {
    std::cerr << "ERROR: " << error.what() << '\n';
  }
  MPI_Finalize();
  return status;
}
