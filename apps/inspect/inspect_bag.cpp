#include "apps/inspect/inspect_bag.hpp"

#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>

#include "apps/console/table.hpp"
#include "datasets/ros/bag_source.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

int inspect_bag(const InspectOptions& options, Console& console) {
  const std::string name = options.map.string();
  if (!options.at.empty() || !options.rays.empty() || !options.slices.empty() || !options.exports.empty() ||
      !options.view.empty() || !options.save.empty() || !options.diff.empty() || options.conflicts ||
      options.holes)
    throw std::invalid_argument(quote_path(name) + " is a bag: expected no other flag than --json beside it");
  const std::vector<BagTopic> topics = list_bag(options.map);
  nlohmann::ordered_json json{{"bag", name}, {"topics", nlohmann::ordered_json::array()}};
  std::vector<std::vector<std::string>> rows{{"topic", "type", "messages"}};
  for (const BagTopic& topic : topics) {
    json["topics"].push_back({{"name", topic.name}, {"type", topic.type}, {"messages", topic.count}});
    rows.push_back({plain(topic.name), plain(topic.type), std::to_string(topic.count)});
  }
  if (console.json) {
    console.out() << json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
  } else {
    print_table(console.out(), rows);
  }
  return exit_done;
}

}  // namespace clearway
