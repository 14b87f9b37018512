// What libc++ calls where its checks fail; a program may define it, and no C++ library is linked here.
#include <__verbose_abort>
#include <cstdlib>

void std::__libcpp_verbose_abort(const char * /*format*/, ...) noexcept { std::abort(); }
