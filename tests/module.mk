# Building and testing.
packages += gcc make pkg-config libc6-dev git perl clang clang-format libclang-rt-14-dev libomp-14-dev
