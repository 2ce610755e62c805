#pragma once

// Before a function: compiled for several instruction sets, the processor's widest is called. With
// exactly rounded operations and no fused ones (-ffp-contract=off) the choice changes no bit. Not
// under sanitizers: their start-up code runs after the resolvers of such functions, which then
// crash.
#if defined(IRSIG_SANITIZED)
#define IRSIG_CLONES
#else
#define IRSIG_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#endif
