#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {

constexpr const char* kSoftwareWebGl = "--use-angle=swiftshader --enable-unsafe-swiftshader";
constexpr const char* kNoWebGl = "--disable-gpu --disable-software-rasterizer";

/// Opens pages in a real browser: Chromium, headless.
class PageInChromium : public testing::Test {
 protected:
  /// The document after the page's script has run; `after` follows the file's name in the address.
  std::string open(const std::string& html, const std::string& after = "", const char* gpu = kSoftwareWebGl) {
    folder_.write("page.html", html);
    const std::string command =
        "timeout 100 chromium --headless --no-sandbox --disable-background-networking --no-first-run "
        "--disable-component-update --disable-sync --hide-scrollbars --user-data-dir='" +
        (folder_ / "profile").string() + "' --window-size=1280,800 --virtual-time-budget=4000 " + gpu +
        " --dump-dom 'file://" + (folder_ / "page.html").string() + after + "' 2>/dev/null";
    std::string dom;
    FILE* pipe = popen(command.c_str(), "r");
    std::array<char, 65536> chunk;
    while (const std::size_t n = fread(chunk.data(), 1, chunk.size(), pipe)) dom.append(chunk.data(), n);
    EXPECT_EQ(pclose(pipe), 0) << "chromium failed or is not installed";
    return dom;
  }

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
};

}  // namespace clearway
