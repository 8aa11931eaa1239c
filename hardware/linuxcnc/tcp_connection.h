// A TCP connection in which no step can wait for ever.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace trueblade {

class TcpConnection {
 public:
  // Throws MachineFault (connection) naming host, port and the system's reason: not found, refused, or no
  // answer within the time.
  TcpConnection(const std::string& host, std::uint16_t port, double timeout_s);
  ~TcpConnection();
  TcpConnection(const TcpConnection&) = delete;
  TcpConnection& operator=(const TcpConnection&) = delete;

  // Throws MachineFault (connection) when the peer has closed or does not take the bytes within the time.
  void send_all(std::string_view bytes, double timeout_s);
  // What has arrived, at most 64 KiB; empty when nothing came within the time (0: at once). Throws
  // MachineFault (connection) when the peer has closed.
  std::string receive(double timeout_s);
  // A few bytes, without waiting and without throwing; safe from any thread.
  bool send_now(std::string_view bytes) noexcept;

 private:
  [[noreturn]] void fail(const std::string& what) const;

  std::string peer_;
  int socket_ = -1;
};

}  // namespace trueblade
