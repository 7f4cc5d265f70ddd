#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {

constexpr const char* kSoftwareWebGl = "--use-angle=swiftshader --enable-unsafe-swiftshader";
constexpr const char* kNoWebGl = "--disable-gpu --disable-software-rasterizer";

/// One Chromium, headless, for many pages: it is driven by messages of the DevTools protocol.
class Chromium {
 public:
  using Json = nlohmann::json;

  /// @throws std::runtime_error when no browser answers.
  explicit Chromium(const std::string& gpu) {
    std::array<int, 2> ends;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
      throw std::runtime_error("no socket for chromium");
    const std::string command =
        "exec chromium --headless --no-sandbox --disable-background-networking --no-first-run "
        "--disable-component-update --disable-sync --disable-features=BackForwardCache --hide-scrollbars "
        "--remote-debugging-pipe "
        "--user-data-dir='" +
        profile_.path().string() + "' --window-size=1000,560 " + gpu + " about:blank >/dev/null 2>&1";
    process_ = fork();
    if (process_ == 0) {  // the browser reads from 3 and writes to 4
      const int own = fcntl(ends[1], F_DUPFD_CLOEXEC, 10);
      if (dup2(own, 3) == 3 && dup2(own, 4) == 4) execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    close(ends[1]);
    socket_ = ends[0];
  }
  Chromium(const Chromium&) = delete;
  Chromium& operator=(const Chromium&) = delete;

  /// Without its socket the browser ends.
  ~Chromium() {
    close(socket_);
    waitpid(process_, nullptr, 0);
  }

  /// The document at `address` after four seconds of a clock that does not wait where there is nothing to do.
  /// The page takes the place of the one before; of a file: no page keeps anything in the browser.
  std::string document(const std::string& address) {
    if (session_.empty()) open_window();
    events_.clear();
    const Json begun = call("Page.navigate", {{"url", address}});
    if (begun.contains("errorText")) throw std::runtime_error(address + ": " + begun["errorText"].dump());
    while (loaded_ != begun.value("loaderId", ""))
      read_message();  // a budget before would be the last page's
    call("Emulation.setVirtualTimePolicy", {{"policy", "pauseIfNetworkFetchesPending"},
                                            {"budget", 4000},
                                            {"maxVirtualTimeTaskStarvationCount", 9999}});
    wait_for("Emulation.virtualTimeBudgetExpired");
    return call("Runtime.evaluate",
                {{"expression", "document.documentElement.outerHTML"}})["result"]["value"];
  }

 private:
  void open_window() {
    const Json parameters = {{"url", "about:blank"}, {"newWindow", true}, {"width", 1000}, {"height", 560}};
    const Json target = call("Target.createTarget", parameters)["targetId"];
    session_ = call("Target.attachToTarget", {{"targetId", target}, {"flatten", true}})["sessionId"];
    call("Page.enable");
  }

  /// What the browser answers.
  Json call(const std::string& method, const Json& parameters = Json::object()) {
    Json message = {{"id", ++last_id_}, {"method", method}, {"params", parameters}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump();
    for (std::size_t sent = 0; sent <= text.size();) {  // with the zero that ends it
      const ssize_t n = send(socket_, text.c_str() + sent, text.size() + 1 - sent, MSG_NOSIGNAL);
      if (n <= 0) throw std::runtime_error("chromium takes no message");
      sent += static_cast<std::size_t>(n);
    }
    while (true) {
      const Json answer = read_message();
      if (answer.value("id", 0) != last_id_) continue;
      if (answer.contains("error")) throw std::runtime_error(method + ": " + answer["error"].dump());
      return answer["result"];
    }
  }

  /// Of this page's events: one that came already counts.
  void wait_for(const std::string& event) {
    while (!events_.contains(event)) read_message();
  }

  Json read_message() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(100);
    std::size_t zero;
    while ((zero = unread_.find('\0')) == std::string::npos) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
      pollfd file{socket_, POLLIN, 0};
      if (left.count() <= 0 || poll(&file, 1, static_cast<int>(left.count())) <= 0)
        throw std::runtime_error("chromium did not answer within 100 s");
      std::array<char, 65536> chunk;
      const ssize_t n = read(socket_, chunk.data(), chunk.size());
      if (n <= 0) throw std::runtime_error("chromium failed or is not installed");
      unread_.append(chunk.data(), static_cast<std::size_t>(n));
    }
    const Json message = Json::parse(unread_.substr(0, zero));
    unread_.erase(0, zero + 1);
    if (!session_.empty() && message.value("sessionId", "") == session_) note_event(message);
    return message;
  }

  void note_event(const Json& message) {
    events_.insert(message.value("method", ""));
    if (message.value("method", "") == "Page.frameNavigated")
      loaded_ = message["params"]["frame"].value("loaderId", "");
  }

  TemporaryFolder profile_;
  pid_t process_ = -1;
  int socket_ = -1, last_id_ = 0;
  std::string session_, unread_, loaded_;
  std::set<std::string> events_;
};

/// Opens pages in a real browser. The cases of a suite share it, because it takes longer to start than a
/// page.
class PageInChromium : public testing::Test {
 protected:
  /// The document after the page's script has run; `after` follows the file's name in the address.
  std::string open(const std::string& html, const std::string& after = "", const char* gpu = kSoftwareWebGl) {
    const std::string file = folder_.write("page" + std::to_string(++pages_) + ".html", html);
    std::unique_ptr<Chromium>& browser = browsers_[gpu];
    try {
      if (!browser) browser = std::make_unique<Chromium>(gpu);
      return browser->document("file://" + file + after);
    } catch (const std::exception&) {
      browser.reset();  // the next page gets a browser that answers
      throw;
    }
  }

  static void TearDownTestSuite() { browsers_.clear(); }

  static std::string attribute(const std::string& dom, const std::string& name) {
    const std::size_t at = dom.find("<body");
    const std::string body = at == std::string::npos ? "" : dom.substr(at, dom.find('>', at) - at);
    const std::string start = " data-" + name + "=\"";
    const std::size_t value = body.find(start);
    if (value == std::string::npos) return "";
    return body.substr(value + start.size(), body.find('"', value + start.size()) - value - start.size());
  }

  static std::string errors(const std::string& dom) {
    const std::size_t at = dom.find("id=\"errors\"");
    return at == std::string::npos ? "no page" : dom.substr(at, dom.find("</pre>", at) - at);
  }

  TemporaryFolder folder_;

 private:
  int pages_ = 0;  ///< each has a name of its own: going elsewhere in a page does not run its script again
  inline static std::map<std::string, std::unique_ptr<Chromium>> browsers_;  ///< by their flags
};

}  // namespace clearway
