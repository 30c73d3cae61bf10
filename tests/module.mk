packages += gcc make pkg-config perl clang clang-format libclang-rt-14-dev
