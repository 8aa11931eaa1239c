// Ctrl-C (SIGINT) and SIGTERM end the work at the next sample or step, and what is finished is kept. A second
// Ctrl-C ends the program at once.
#pragma once

namespace trueblade {

// Also lets a file that outgrows the user's limit (SIGXFSZ) fail as on a full disk, with a message.
void catch_interrupts();
bool interrupted();

}  // namespace trueblade
