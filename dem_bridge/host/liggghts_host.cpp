/// liggghts_host --driver PROCESS --socket PATH: LIGGGHTS behind the wire. Started by tuft; given the shared
/// memory at the socket; answers one request at a time until told to quit or until the driver is gone. Under
/// mpirun each rank has its own connection.
#include <mpi.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <thread>

#include "dem_bridge/host/liggghts_engine.h"
#include "dem_bridge/host/serve.h"
#include "dem_bridge/message_socket.h"
#include "dem_bridge/protocol.h"
#include "dem_bridge/shared_memory.h"

namespace {

using namespace tuft::dem;

/// Ends this process when the driver ends, whatever LIGGGHTS is at. (As a child of the driver the kernel does
/// so at once; a rank is a child of mpirun.)
void end_with_driver(pid_t driver) {
  const int watch = static_cast<int>(::syscall(SYS_pidfd_open, driver, 0));
  if (watch < 0) ::_exit(EXIT_FAILURE);  // it is gone already
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

}  // namespace

int main(int count, char** arguments) {
  if (count != 5 || std::string_view(arguments[1]) != "--driver" ||
      std::string_view(arguments[3]) != "--socket") {
    std::cerr << "liggghts_host is started by tuft; usage: liggghts_host --driver PROCESS --socket PATH\n";
    return 2;
  }
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  end_with_driver(static_cast<pid_t>(std::strtol(arguments[2], nullptr, 10)));
  MPI_Init(nullptr, nullptr);
  int status = EXIT_FAILURE;
  try {
    status = run(arguments[4]);
  } catch (const std::exception& error) {
    std::cerr << "ERROR: " << error.what() << '\n';
  }
  MPI_Finalize();
  return status;
}
