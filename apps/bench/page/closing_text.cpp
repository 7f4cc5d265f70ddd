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

## Older figures

No command repeats these; the commit has the code that they were measured with. CPU time, two shared cores.

| what                                                                | figure             | commit    |
|---------------------------------------------------------------------|--------------------|-----------|
| when voxels were last seen: share of insertion's time, 5 / 2 / 1 cm | 2.1 / 3.0 / 3.3 %  | `13cae5a` |
| the same, its memory beside the tree's 5.6 MB (760,000 voxels)      | 1.45 MB            | `13cae5a` |
| `idle_turns` on the borders of Figs. 16 and 17: nodes that are left | a third to a ninth | `2fa857b` |
| a scan of a team's world, 2 × 217,538 rays, in all                  | 200 to 300 ms      | `0594cad` |
| corner noise of rendered tags, f = 600 px                           | 0.05 to 0.06 px    | `26b6c37` |
| a tag turned by more than 20° that is accepted                      | 0                  | `26b6c37` |
)";
}

}  // namespace clearway::bench
