#pragma once
/// What both ends of a ZeroMQ connection share: how a peer that is gone is noticed, and multipart messages.
#include <string>
#include <vector>
#include <zmq.hpp>

namespace tuft::dem {

/// A machine or network that is gone is noticed after `heartbeat_timeout`, a process that is gone at once.
/// ZeroMQ's own thread answers heartbeats, however long a program computes.
inline constexpr int heartbeat_interval = 1000, heartbeat_timeout = 5000;  // ms
inline constexpr const char* monitor_endpoint = "inproc://monitor";

/// A PAIR socket whose connection is watched; connect or bind it after the monitor's socket is connected.
inline void prepare_link(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::linger, 1000);
  socket.set(zmq::sockopt::heartbeat_ivl, heartbeat_interval);
  socket.set(zmq::sockopt::heartbeat_timeout, heartbeat_timeout);
  socket.set(zmq::sockopt::heartbeat_ttl, heartbeat_timeout);
  socket.set(zmq::sockopt::sndhwm, 0);
  socket.set(zmq::sockopt::rcvhwm, 0);
  zmq_socket_monitor(socket.handle(), monitor_endpoint,
                     ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_HANDSHAKE_SUCCEEDED | ZMQ_EVENT_DISCONNECTED);
}

struct LinkEvent {
  int kind = 0;        ///< ZMQ_EVENT_...; 0: there was none
  int descriptor = 0;  ///< of the connection
};

/// Takes an event from a monitor; never waits.
inline LinkEvent take_event(zmq::socket_t& monitor) {
  zmq::message_t event, address;
  if (!monitor.recv(event, zmq::recv_flags::dontwait) || event.size() < 6) return {};
  (void)monitor.recv(address);
  const auto* const bytes = event.data<unsigned char>();
  LinkEvent result;
  result.kind = bytes[0] | bytes[1] << 8;
  result.descriptor = bytes[2] | bytes[3] << 8 | bytes[4] << 16 | bytes[5] << 24;
  return result;
}

inline void send_frames(zmq::socket_t& socket, const std::vector<std::string>& frames) {
  for (std::size_t f = 0; f < frames.size(); ++f)
    socket.send(zmq::buffer(frames[f]),
                f + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
}

/// A whole message if one is there, else none; never waits.
inline std::vector<zmq::message_t> take_frames(zmq::socket_t& socket) {
  std::vector<zmq::message_t> frames(1);
  if (!socket.recv(frames[0], zmq::recv_flags::dontwait)) return {};
  while (frames.back().more()) {
    frames.emplace_back();
    (void)socket.recv(frames.back());
  }
  return frames;
}

}  // namespace tuft::dem
