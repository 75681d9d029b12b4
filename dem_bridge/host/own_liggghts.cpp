#include "dem_bridge/host/own_liggghts.h"

#include <mpi.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "dem_bridge/host/liggghts_engine.h"
#include "dem_bridge/host/listen.h"
#include "dem_bridge/host/serve.h"
#include "dem_bridge/last_words.h"

namespace tuft::dem {
namespace {

/// Answers at once, and is never gone: it goes with this process.
class OwnLiggghts final : public HostWire {
 public:
  explicit OwnLiggghts(std::size_t grains) : memory_(SharedMemory::create(grains)) {
    MPI_Init(nullptr, nullptr);
    engine_ = new LiggghtsEngine(memory_, 0);
  }

  Outcome exchange(std::string_view message, Clock::time_point, std::vector<std::string>& answers) override {
    answers = {answer_to(*engine_, std::string(message))};
    return Outcome::answered;
  }
  void quit(std::string_view) override {}
  std::string how_it_went() override { return "ended"; }
  std::string last_words() override { return error_line(memory_.words()); }
  std::string why_silent() const override { return {}; }
  void kill() override {}

  void write_file(const std::string& name, const std::vector<std::uint8_t>& bytes) override {
    std::ofstream stream(name, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream) throw std::runtime_error("it cannot be written on the host's machine");
  }
  std::vector<std::uint8_t> take_file(const std::string& name) override {
    std::ifstream stream(name, std::ios::binary);
    std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (!stream || bytes.empty()) throw std::runtime_error("LIGGGHTS left no such file");
    std::filesystem::remove(name);
    return bytes;
  }

  SharedMemory& memory() override { return memory_; }
  int process_id() const override { return 0; }

 private:
  SharedMemory memory_;
  LiggghtsEngine* engine_ = nullptr;  // never deleted: this process ends with it
};

}  // namespace

std::unique_ptr<HostWire> start_own_liggghts(std::size_t grains) {
  return std::make_unique<OwnLiggghts>(grains);
}

}  // namespace tuft::dem

/// An error that one rank alone has met ends LIGGGHTS so, and no function that was registered for the end of
/// the program is called. MPI lets a program put its own in front of its functions.
extern "C" int MPI_Abort(MPI_Comm all, int code) {
  tuft::dem::say_last_words();
  return PMPI_Abort(all, code);
}
