"""unpack-kernel.py VMLINUZ VMLINUX: the kernel without its decompressor, which QEMU starts seconds sooner."""
import lzma
import sys

data = open(sys.argv[1], "rb").read()
begin = data.find(b"\xfd7zXZ\x00")
if begin < 0:
    sys.exit(f"{sys.argv[1]}: holds no xz stream")
open(sys.argv[2], "wb").write(lzma.LZMADecompressor().decompress(data[begin:]))
