#pragma once

#include <zlib.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace clearway {

/// Reads a rendered report page back, as a browser does: the JSON, and the arrays it points into.
class PageReader {
 public:
  explicit PageReader(const std::string& html)
      : page(nlohmann::json::parse(element(html, "<script type=\"application/json\" id=\"page\">"))),
        arrays_(inflated(from_base64(element(html, "<script type=\"text/plain\" id=\"arrays\">")))) {}

  template <class T>
  std::vector<T> array(const nlohmann::json& place) const {
    std::vector<T> values(place.at("count").get<std::size_t>());
    const auto offset = place.at("offset").get<std::size_t>();
    if (offset % 4 != 0 || offset + values.size() * sizeof(T) > arrays_.size())
      throw std::out_of_range("array outside the page's arrays");
    if (!values.empty()) std::memcpy(values.data(), arrays_.data() + offset, values.size() * sizeof(T));
    return values;
  }

  static std::string element(const std::string& html, const std::string& start) {
    const std::size_t from = html.find(start) + start.size();
    return html.substr(from, html.find("</script>", from) - from);
  }

  nlohmann::json page;

 private:
  static std::string from_base64(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    unsigned bits = 0, held = 0;
    for (const char c : text.substr(0, text.find('='))) {
      held = held << 6 | static_cast<unsigned>(digits.find(c));
      bits += 6;
      if (bits < 8) continue;
      bits -= 8;
      out += static_cast<char>(held >> bits & 0xff);
    }
    return out;
  }

  static std::string inflated(std::string bytes) {
    z_stream stream{};
    inflateInit2(&stream, 15 + 16);
    stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
    stream.avail_in = static_cast<uInt>(bytes.size());
    std::string out, chunk(65536, '\0');
    int status = Z_OK;
    while (status == Z_OK) {
      stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
      stream.avail_out = static_cast<uInt>(chunk.size());
      status = inflate(&stream, Z_NO_FLUSH);
      out.append(chunk, 0, chunk.size() - stream.avail_out);
    }
    inflateEnd(&stream);
    if (status != Z_STREAM_END || stream.avail_in != 0)
      throw std::runtime_error("the arrays are no whole gzip");
    return out;
  }

  std::string arrays_;
};

}  // namespace clearway
