// Memory of this process: how much, and the heap given back.
#pragma once

namespace talus {

/// bytes, resident; `now` is the peak where the system does not tell.
struct MemoryUse {
    double now = 0.0, peak = 0.0;
};
MemoryUse memory_use();

/// bytes that can be had without driving the system to swap; infinite where it does not tell.
double available_memory();

/// bytes asked of the heap and not given back; 0 where the C library does not tell.
double heap_in_use();

/// Returns to the system what the heap holds in reserve after work that needed much memory for a short time. Does nothing
/// where the C library cannot.
void release_unused_memory();

}  // namespace talus
