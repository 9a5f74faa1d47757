#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

namespace reflection {

/// A zeroed array of plain values on cache-line borders, in huge pages where the system has them: tables of
/// many megabytes that are read in scattered places would else spend their time on address translation.
template <class T>
class LargeArray {
  public:
    LargeArray() = default;
    /// Throws std::bad_alloc.
    explicit LargeArray(std::size_t count) : size_(count) {
        constexpr std::size_t hugePage = std::size_t{1} << 21;
        const std::size_t bytes = count * sizeof(T);
        const std::size_t alignment = bytes >= hugePage ? hugePage : 64;
        const std::size_t whole = (bytes + alignment - 1) / alignment * alignment;
        data_.reset(static_cast<T*>(std::aligned_alloc(alignment, whole > 0 ? whole : alignment)));
        if (!data_) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
        if (alignment == hugePage)
            madvise(data_.get(), whole, MADV_HUGEPAGE);  // a wish: failure changes nothing
#endif
        for (std::size_t k = 0; k < count; ++k) data_[k] = T{};
    }

    std::size_t size() const {
        return size_;
    }
    T* data() {
        return data_.get();
    }
    const T* data() const {
        return data_.get();
    }
    T& operator[](std::size_t k) {
        return data_[k];
    }
    const T& operator[](std::size_t k) const {
        return data_[k];
    }

  private:
    struct Free {
        void operator()(T* p) const { std::free(p); }
    };
    std::unique_ptr<T[], Free> data_;
    std::size_t size_ = 0;
};

}  // namespace reflection
