"""screen-look.py TAP MONITOR OUT: for each line "# picture NAME" that comes into TAP, QEMU at the socket MONITOR writes what its screen shows to
OUT/NAME.ppm (and .png, where it is another picture than before), and OUT/NAME.mean tells how bright that is, 0 to 255, which the guest reads."""
import os
import socket
import sys
import time

tap, monitor, out = sys.argv[1:]
done = set()


def ask(command):
    with socket.socket(socket.AF_UNIX) as s:
        s.settimeout(20)
        s.connect(monitor)
        said = b""
        while b"(qemu)" not in said:
            said += s.recv(4096)
        s.sendall(command.encode() + b"\n")
        said = b""
        while b"(qemu)" not in said:
            said += s.recv(4096)
        return said


def look(name):
    ppm = os.path.join(out, name + ".ppm")
    ask(f"screendump {ppm}")
    with open(ppm, "rb") as f:
        data = f.read()
    head = data.split(b"\n", 3)
    pixels = head[3][::97]
    if pixels != look.before:
        ask(f"screendump {os.path.join(out, name + '.png')} -f png")
    look.before = pixels
    with open(os.path.join(out, name + ".new"), "w") as f:
        f.write(f"{sum(pixels) / max(len(pixels), 1):.0f} {head[1].decode()}\n")
    os.rename(os.path.join(out, name + ".new"), os.path.join(out, name + ".mean"))


look.before = None
while True:
    try:
        with open(tap, "rb") as f:
            lines = f.read().decode(errors="replace").splitlines(keepends=True)
    except FileNotFoundError:
        lines = []
    for line in lines:
        words = line.split()
        if line.endswith("\n") and words[:2] == ["#", "picture"] and words[2] not in done:
            look(words[2])
            done.add(words[2])
    time.sleep(0.2)
