#pragma once

#include "core/accuracy/replicates.h"
#include "core/signature/view/result.h"

namespace irsig {

// Adds an estimate of independent samples: values add up, standard errors in squares, and of the
// modes of spectra the leading ones are kept.
void add(const Estimate& more, Estimate& to);
void add(const SpectralEstimate& more, SpectralEstimate& to);

}  // namespace irsig
