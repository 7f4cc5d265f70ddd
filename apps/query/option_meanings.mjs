// Writes the comments beside the planners' options as a C++ table: option_meaning() has this one source.
//   node option_meanings.mjs OUTPUT.cpp HEADER...
import { readFileSync, writeFileSync } from "node:fs";

const structs = {
  auto: "AutoPlannerOptions", beam: "BeamOptions", beam_guided: "BeamGuidedOptions", beam_reference: "BeamOptions",
  bitstar: "BitStarOptions", bitstar_fcl: "BitStarFclOptions", boundary: "BoundaryOptions", boundary_plus: "BoundaryPlusOptions",
  boundary_sides: "BoundaryOptions", constraint: "ConstraintOptions", est: "EstOptions", kpiece_fcl: "KpieceFclOptions",
  prm: "PrmOptions", prm_fcl: "PrmFclOptions", rrtconnect: "RrtConnectOptions", rrtconnect_fcl: "RrtConnectFclOptions",
  rrtconnect_ompl: "RrtConnectOmplOptions", rrtstar: "RrtStarOptions",
};

const [output, ...headers] = process.argv.slice(2);
const found = new Map();  // struct -> [{ type, name, comment }]

/// Members with their comments, which may go on in the next lines.
function membersOf(body) {
  const members = [];
  for (const line of body.split("\n")) {
    const [code, comment] = line.split("///<").map((part) => part.trim());
    const declared = /^([\w:<>]+)\s+(\w+)\s*(=.*)?;$/.exec(code);
    if (declared) members.push({ type: declared[1], name: declared[2], comment: comment ?? "" });
    else if (code === "" && comment && members.length > 0) members.at(-1).comment += ` ${comment}`;
  }
  return members;
}

for (const header of headers)
  for (const [, name, body] of readFileSync(header, "utf8").matchAll(/struct (\w+Options) \{\n([\s\S]*?)\n\};/g))
    found.set(name, membersOf(body));

/// Of a struct and the structs of options in it; its own members count first.
function optionsOf(struct) {
  const members = found.get(struct) ?? [], inner = members.filter(({ type }) => found.has(type));
  return new Map([...inner.flatMap(({ type }) => [...optionsOf(type)]), ...members.filter(({ comment }) => comment !== "").map(({ name, comment }) => [name, comment])]);
}

const planners = Object.entries(structs);
const entries = planners.flatMap(([planner, struct]) => [...optionsOf(struct)].map(([option, meaning]) =>
  `    {{"${planner}", "${option}"}, ${JSON.stringify(meaning)}},`)).sort();
writeFileSync(output, `// Written by option_meanings.mjs.
#include <map>
#include <string>
#include <utility>

#include "apps/query/option_meanings.hpp"

namespace clearway {

std::string option_meaning(const std::string& planner, const std::string& option) {
  static const std::map<std::pair<std::string, std::string>, std::string> meanings = {
${entries.join("\n")}
  };
  const auto found = meanings.find({planner, option});
  return found == meanings.end() ? std::string() : found->second;
}

}  // namespace clearway
`);
