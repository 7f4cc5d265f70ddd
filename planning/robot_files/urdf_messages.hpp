#pragma once

#include <console_bridge/console.h>

#include <mutex>
#include <string>

namespace clearway {

/// Keeps urdfdom's messages for our own sentence instead of printing them. The handler is a global of
/// console_bridge, so one file is read at a time.
class KeptMessages : public console_bridge::OutputHandler {
 public:
  KeptMessages() { console_bridge::useOutputHandler(this); }
  ~KeptMessages() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first.empty()) first = text;
  }
  std::string first;

 private:
  static std::mutex& gate() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> turn_{gate()};
};

}  // namespace clearway
