#pragma once

#include <map>
#include <string>

#include "jobs/text/section_check.h"
#include "schema/sweep.pb.h"

namespace irsig {

// Returns the path of an object: "land.object[2]".
[[nodiscard]] std::string land_object_path(int i);

// Adds the files that the tables [[land.object]] name, by the key of each.
void add_land_object_files(const schema::Land& land, std::map<std::string, std::string>& files);

// Checks [[land.object]] and whether each material of objects alone has one.
void check_land_objects(const schema::Land& land, Findings& findings);
void write_land_object_defaults(schema::Land& land);

}  // namespace irsig
