// Preloaded into programs of LinuxCNC that listen on every interface and have no option for it
// (hardware/linuxcnc/config/bin): a socket that would be bound to every interface is bound to the IPv4
// address TRUEBLADE_LISTEN_ON, or to the loopback where that is not set. An address that is none, and IPv6 on
// every interface, are refused. A program that names an address gets it.
#include <arpa/inet.h>
#include <dlfcn.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

namespace {

template <class Address>
Address address_as(const sockaddr* bytes) {
  Address address;
  std::memcpy(&address, bytes, sizeof(address));
  return address;
}

int refused(int reason) {
  errno = reason;
  return -1;
}

}  // namespace

extern "C" int bind(int socket, const sockaddr* address, socklen_t length) noexcept {
  static const auto system_bind = reinterpret_cast<decltype(&bind)>(::dlsym(RTLD_NEXT, "bind"));
  if (address->sa_family == AF_INET6 && length >= sizeof(sockaddr_in6)) {
    const in6_addr wanted = address_as<sockaddr_in6>(address).sin6_addr;
    if (IN6_IS_ADDR_UNSPECIFIED(&wanted)) return refused(EAFNOSUPPORT);
  }
  if (address->sa_family != AF_INET || length < sizeof(sockaddr_in))
    return system_bind(socket, address, length);
  auto wanted = address_as<sockaddr_in>(address);
  if (wanted.sin_addr.s_addr != htonl(INADDR_ANY)) return system_bind(socket, address, length);
  const char* instead = std::getenv("TRUEBLADE_LISTEN_ON");
  if (::inet_pton(AF_INET, instead ? instead : "127.0.0.1", &wanted.sin_addr) != 1)
    return refused(EADDRNOTAVAIL);
  return system_bind(socket, reinterpret_cast<const sockaddr*>(&wanted), sizeof(wanted));
}
