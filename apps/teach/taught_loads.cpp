#include "apps/teach/taught_loads.hpp"

#include <algorithm>
#include <stdexcept>

#include "apps/query/loads.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// Of all loads of the setup.
std::vector<std::string> names_of_loads(const Setup& setup) {
  std::vector<std::string> names;
  for (const LoadSetup& load : setup.loads) names.push_back(load.name);
  for (const QuerySetup& query : setup.queries)
    for (const LoadSetup& load : query.loads) names.push_back(load.name);
  return names;
}

/// @throws std::invalid_argument when queries have different loads of that name, and `loads` does not say
/// which.
void require_one_of(const std::string& name, const Load& found, const Setup& setup) {
  const auto has_name = [&](const LoadSetup& load) { return load.name == name; };
  if (std::any_of(setup.loads.begin(), setup.loads.end(), has_name)) return;
  for (const QuerySetup& query : setup.queries)
    for (const LoadSetup& load : query.loads)
      if (has_name(load) && !is_same(leg_load(load).load, found))
        throw std::invalid_argument(
            "queries of the setup have different loads " + quote(shortened(name)) +
            "; expected the one that is meant in the setup's 'loads', or in the event");
}

}  // namespace

Load load_of(const TeachEvent& event, const Setup& setup) {
  const LoadSetup* known = event.load ? &event.load->setup : setup.load(event.name);
  if (known != nullptr) {
    const Load load = leg_load(*known).load;
    if (!event.load) require_one_of(event.name, load, setup);
    return load;
  }
  const std::vector<std::string> names = names_of_loads(setup);
  throw std::invalid_argument("the setup has no load " + quote(shortened(event.name)) +
                              (names.empty() ? ", nor any other; the event may bring one with it, as 'load'"
                                             : ", " + suggestion(event.name, names)));
}

bool are_same(const std::vector<Load>& a, const std::vector<Load>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const Load& x, const Load& y) { return is_same(x, y); });
}

bool holds(const std::vector<Load>& held, const std::string& name) {
  return std::any_of(held.begin(), held.end(), [&](const Load& load) { return load.name == name; });
}

std::vector<LegLoad> loads_of_legs(const std::vector<TaughtPlace>& ends) {
  std::vector<LegLoad> loads;
  for (std::size_t leg = 0; leg < ends.size(); ++leg)
    for (const Load& load : ends[leg].held) {
      auto known = std::find_if(loads.begin(), loads.end(),
                                [&](const LegLoad& one) { return one.load.name == load.name; });
      if (known == loads.end()) known = loads.insert(loads.end(), LegLoad{load, {}});
      known->legs.push_back(static_cast<int>(leg));
    }
  for (LegLoad& load : loads)
    if (load.legs.size() == ends.size()) load.legs.clear();
  return loads;
}

std::string names_of(const std::vector<Load>& held) {
  std::string text;
  for (std::size_t i = 0; i < held.size(); ++i)
    text += (i == 0 ? "" : i + 1 == held.size() ? " and " : ", ") + quote(held[i].name);
  return text.empty() ? "nothing" : text;
}

}  // namespace clearway
