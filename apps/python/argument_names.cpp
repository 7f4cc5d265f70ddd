#include "apps/python/argument_names.hpp"

#include "apps/console/flag_names.hpp"

namespace clearway {

std::string with_argument_names(const std::string& sentence) {
  static const FlagNames names{{"--fix", "fixed"},
                               {"--group", "group"},
                               {"--srdf", "srdf"},
                               {"--package", "packages"},
                               {"--xacro", "xacro"},
                               {"--standing", "standing"},
                               {"--scale", "scale"},
                               {"--base", "map_from_base"},
                               {"--tip", "tip"},
                               {"--attach", "loads"},
                               {"--policy", "policies"},
                               {"--padding", "padding"},
                               {"--seen-within", "seen_within"},
                               {"--allow-outside", "allow_outside"},
                               {"--strict", "strict"},
                               {"--cloud-resolution", "cloud_resolution"}};
  return with_names(sentence, names);
}

}  // namespace clearway
