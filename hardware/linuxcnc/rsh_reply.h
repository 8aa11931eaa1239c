// Replies of linuxcncrsh, LinuxCNC's text interface (man page linuxcncrsh(1)), as they come over the network.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trueblade {

struct RshReply {
  enum class Kind {
    hello_accepted,
    hello_refused,
    set_accepted,
    set_refused,
    get_refused,
    value,        // of a get: words after the name
    unrecognised  // noise, or an echo
  };
  Kind kind = Kind::unrecognised;
  std::string name;                // of the setting or value, lower case
  std::vector<std::string> words;  // of a value, as sent
  std::string text;                // the same in one piece
};

// Pure; any bytes are a valid argument.
RshReply parse_rsh_reply(std::string_view line);

// The finite numbers of a value, as many as are asked for; nullopt when there are fewer or they are no
// numbers.
std::optional<std::vector<double>> numbers_of(const RshReply& value, std::size_t count);

}  // namespace trueblade
