#pragma once

namespace irsig {

// Lets this process keep what it frees, for the next time that it needs as much: a view allocates
// and frees arrays of some megabytes over and over, and each page that comes from the kernel anew
// costs a fault, for which threads of one process also wait for each other. Called first thing in
// main. The process grows to the most that it ever needed at once, and stays so large.
void keep_freed_memory();

}  // namespace irsig
