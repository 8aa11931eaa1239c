#include "part/cad_guard.h"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <mutex>
#include <new>

#include "geometry/error.h"

namespace trueblade {

namespace {

class SilentMessenger {
 public:
  SilentMessenger() : printers_(Message::DefaultMessenger()->Printers()) {
    Message::DefaultMessenger()->ChangePrinters().Clear();
  }
  ~SilentMessenger() { Message::DefaultMessenger()->ChangePrinters() = printers_; }
  SilentMessenger(const SilentMessenger&) = delete;
  SilentMessenger& operator=(const SilentMessenger&) = delete;

 private:
  Message_SequenceOfPrinters printers_;
};

}  // namespace

void with_cad_kernel(const std::filesystem::path& file, const char* doing,
                     const std::function<void()>& work) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const SilentMessenger silent;
  try {
    work();
  } catch (const Standard_Failure& failure) {
    const char* reason = failure.GetMessageString();
    throw file_error(file.string(), std::string("could not be ") + doing + " by the CAD kernel: " +
                                        (reason && *reason ? reason : failure.DynamicType()->Name()));
  } catch (const std::bad_alloc&) {
    throw file_error(file.string(), std::string("could not be ") + doing + ": it asks for too much memory");
  }
}

}  // namespace trueblade
