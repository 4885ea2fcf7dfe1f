// The number of threads, as OpenMP has it.
#pragma once

namespace talus {

/// Throws InputError if it is not between 1 and 1024.
void check_threads(int threads);

void use_threads(int threads);

/// Puts the number of threads back to what it was.
class ThreadsKept {
public:
    ThreadsKept();
    ~ThreadsKept();
    ThreadsKept(const ThreadsKept&) = delete;
    ThreadsKept& operator=(const ThreadsKept&) = delete;

private:
    int before_;
};

}  // namespace talus
