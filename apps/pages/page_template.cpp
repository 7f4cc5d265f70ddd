#include "apps/pages/page_template.hpp"

#include <nlohmann/json.hpp>
#include <stdexcept>

namespace clearway {
namespace {

using nlohmann::json;

constexpr std::string_view kTitleMark = "<!--CLEARWAY:TITLE-->";
constexpr std::string_view kDataMark = "<!--CLEARWAY:DATA-->";

std::string replace_each(std::string text, std::string_view from, std::string_view to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/// The text as HTML shows it, with wrong UTF-8 replaced.
std::string html_text(const std::string& text) {
  const std::string quoted = json(text).dump(-1, ' ', false, json::error_handler_t::replace);
  const auto valid = json::parse(quoted).get<std::string>();
  return replace_each(replace_each(valid, "&", "&amp;"), "<", "&lt;");
}

}  // namespace

std::string script_json(std::string json) { return replace_each(std::move(json), "<", "\\u003c"); }

std::string fill_page_template(std::string_view html, const std::string& title, std::string_view elements) {
  const std::size_t title_at = html.find(kTitleMark), data_at = html.find(kDataMark);
  if (title_at == std::string_view::npos || data_at == std::string_view::npos || data_at < title_at)
    throw std::logic_error("the page template lacks its two marks");
  std::string out(html.substr(0, title_at));
  out += html_text(title);
  out += html.substr(title_at + kTitleMark.size(), data_at - title_at - kTitleMark.size());
  out += elements;
  out += html.substr(data_at + kDataMark.size());
  return out;
}

}  // namespace clearway
