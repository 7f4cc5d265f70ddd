#include "apps/bench/page/page.hpp"

namespace clearway::bench {

std::string closing_text() {
  return R"(## What only a suite shows

Each writes a table of *solved / valid / total*, times and costs, and a page to look at, into `DIR`:

| what                                       | command                                                        |
|--------------------------------------------|----------------------------------------------------------------|
| scenes after Chong et al. 2008             | `clearway compare datasets/suites/chong2008.yaml --out DIR`    |
| 120 painted tubes and 100 shelf tasks      | `clearway compare datasets/suites/guided.yaml --out DIR`       |
| the same, FCL's edges as fine as voxels    | `clearway compare datasets/suites/guided_fcl.yaml --out DIR`   |
| 360 reaching problems, 5 to 7 joints       | `clearway compare datasets/suites/local.yaml --out DIR`        |
| 1,400 teams of arms among moving obstacles | `clearway compare datasets/suites/safety.yaml --out DIR`       |
| scenes after Lahouar et al. 2006           | `clearway compare datasets/suites/lahouar2006.yaml --out DIR`  |
)";
}

}  // namespace clearway::bench
