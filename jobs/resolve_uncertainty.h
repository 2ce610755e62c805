#pragma once

#include "jobs/text/section_check.h"

namespace irsig {

// [uncertainty], of a sweep that is resolved but for it: an input that nothing in the sweep depends
// on is an error, since it would silently add nothing. Then writes its default, and a heat run of
// changes (HeatRun.input) for each run whose temperatures depend on one of them.
void resolve_uncertainty(schema::ResolvedSweep& resolved, Findings& findings);

}  // namespace irsig
