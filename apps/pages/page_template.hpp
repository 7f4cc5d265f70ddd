#pragma once

#include <string>
#include <string_view>

namespace clearway {

/// JSON text that cannot end the script element it stands in, nor open a comment there.
std::string script_json(std::string json);

/// A page of apps/viewer with its title and, where its data go, these elements.
/// @param title may be any bytes: what is not UTF-8 is replaced
std::string fill_page_template(std::string_view html, const std::string& title, std::string_view elements);

}  // namespace clearway
