#include "hardware/linuxcnc/tcp_connection.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <memory>
#include <system_error>

#include "hardware/machine_driver.h"

namespace trueblade {
namespace {

using Clock = std::chrono::steady_clock;

Clock::time_point after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

// True when the socket is ready before the deadline.
bool wait_for(int socket, short events, Clock::time_point deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd poll_entry{socket, events, 0};
    const int ready = ::poll(&poll_entry, 1, static_cast<int>(std::max<long>(left, 0)));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

std::string reason_of(int error) {
  return std::generic_category().message(error);
}

// A connected socket, or the reason why not.
int connect_to(const addrinfo& address, Clock::time_point deadline, int& error) {
  const int socket =
      ::socket(address.ai_family, address.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, address.ai_protocol);
  if (socket < 0) {
    error = errno;
    return -1;
  }
  error = ::connect(socket, address.ai_addr, address.ai_addrlen) == 0 ? 0 : errno;
  if (error == EINPROGRESS) {
    socklen_t length = sizeof(error);
    if (!wait_for(socket, POLLOUT, deadline))
      error = ETIMEDOUT;
    else if (::getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &length) != 0)
      error = errno;
  }
  if (error == 0) return socket;
  ::close(socket);
  return -1;
}

}  // namespace

TcpConnection::TcpConnection(const std::string& host, std::uint16_t port, double timeout_s)
    : peer_(fmt::format("{}:{}", host, port)) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); error != 0)
    throw MachineFault(MachineFault::Kind::connection, fmt::format("{}: {}", peer_, ::gai_strerror(error)));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, &::freeaddrinfo);
  int error = 0;
  const Clock::time_point deadline = after(timeout_s);
  for (const addrinfo* address = found; address && socket_ < 0; address = address->ai_next)
    socket_ = connect_to(*address, deadline, error);
  if (socket_ < 0)
    throw MachineFault(MachineFault::Kind::connection,
                       fmt::format("{}: cannot connect: {}", peer_, reason_of(error)));
  const int yes = 1;
  ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
}

TcpConnection::~TcpConnection() {
  ::close(socket_);
}

void TcpConnection::fail(const std::string& what) const {
  throw MachineFault(MachineFault::Kind::connection, fmt::format("{}: {}", peer_, what));
}

void TcpConnection::send_all(std::string_view bytes, double timeout_s) {
  const Clock::time_point deadline = after(timeout_s);
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    } else if (errno == EAGAIN) {
      if (!wait_for(socket_, POLLOUT, deadline)) fail(fmt::format("takes nothing for {} s", timeout_s));
    } else if (errno != EINTR) {
      fail("the connection is lost: " + reason_of(errno));
    }
  }
}

std::string TcpConnection::receive(double timeout_s) {
  if (!wait_for(socket_, POLLIN, after(timeout_s))) return {};
  std::string bytes(65536, '\0');
  const ssize_t received = ::recv(socket_, bytes.data(), bytes.size(), 0);
  if (received == 0) fail("the connection was closed by the other side");
  if (received < 0) {
    if (errno == EAGAIN || errno == EINTR) return {};
    fail("the connection is lost: " + reason_of(errno));
  }
  bytes.resize(static_cast<std::size_t>(received));
  return bytes;
}

bool TcpConnection::send_now(std::string_view bytes) noexcept {
  return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) ==
         static_cast<ssize_t>(bytes.size());
}

}  // namespace trueblade
