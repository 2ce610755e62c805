#pragma once

#include "jobs/text/section_check.h"

namespace irsig {

// Resolves [uncertainty] of a sweep that is resolved otherwise, and writes its default. An input on
// which nothing in the sweep depends is an error, because it would silently add nothing. For each
// run whose temperatures depend on an input, a heat run of changes (HeatRun.input) is added.
void resolve_uncertainty(schema::ResolvedSweep& resolved, Findings& findings);

}  // namespace irsig
