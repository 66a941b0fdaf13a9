"""two_stations.py FILE: writes FILE.e57 and FILE.csv, what a scanner with a camera would have brought home.

Everything around has the colour of its direction from the station, one of eight: east or west, north or south, above or
below. The first station has a picture of a pinhole camera, the second one a panorama; both are painted from what stands
where in the world: a camera has on the right of its picture what is on its right hand, and a panorama shows what comes
into sight when one turns to the right. The CSV file has points of the world (x east, y north, z up) and their colours.
After ASTM E2807: a camera looks along its -z with x to the right and y up; a panorama has its +x in the middle and z up.
"""
import math
import struct
import sys
import zlib


def colour(direction):
    east, north, up = (c > 0 for c in direction)
    return (230 if east else 20, 200 if north else 40, 180 if up else 60)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(sum(c * c for c in a))
    return [c / length for c in a]


def combined(*parts):
    return [sum(share * axis[k] for share, axis in parts) for k in range(3)]


def quaternion(x, y, z):
    """Of the turn whose images of the axes are x, y and z: the eigenvector that power iteration finds."""
    m = [[axis[row] for axis in (x, y, z)] for row in range(3)]
    k = [[m[0][0] + m[1][1] + m[2][2], m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]],
         [m[2][1] - m[1][2], m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[0][2] + m[2][0]],
         [m[0][2] - m[2][0], m[0][1] + m[1][0], m[1][1] - m[0][0] - m[2][2], m[1][2] + m[2][1]],
         [m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], m[2][2] - m[0][0] - m[1][1]]]
    q = [0.5, 0.4, 0.3, 0.2]
    for _ in range(200):
        q = unit4([sum(k[r][c] * q[c] for c in range(4)) + q[r] for r in range(4)])
    return q


def unit4(q):
    length = math.sqrt(sum(c * c for c in q))
    return [c / length for c in q]


def png(rows):
    height, width = len(rows), len(rows[0])

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    packed = zlib.compress(b"".join(b"\0" + bytes(c for pixel in row for c in pixel) for row in rows))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


# --- the file: pages of 1020 bytes and a checksum (CRC-32C) ---

TABLE = []
for number in range(256):
    for _ in range(8):
        number = number >> 1 ^ (0x82F63B78 if number & 1 else 0)
    TABLE.append(number)


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = crc >> 8 ^ TABLE[(crc ^ byte) & 255]
    return crc ^ 0xFFFFFFFF


def place_in_file(at):
    return at // 1020 * 1024 + at % 1020


def pose(axes, origin):
    turn = quaternion(*axes)
    return ("<pose type='Structure'><rotation type='Structure'>"
            + "".join(f"<{n} type='Float'>{v:.17g}</{n}>" for n, v in zip("wxyz", turn))
            + "</rotation><translation type='Structure'>"
            + "".join(f"<{n} type='Float'>{v:.17g}</{n}>" for n, v in zip("xyz", origin)) + "</translation></pose>")


class File:
    def __init__(self):
        self.bytes = bytearray(48)

    def blob(self, data):
        at = place_in_file(len(self.bytes))
        self.bytes += struct.pack("<QQ", 0, 16 + len(data)) + data + bytes(-len(data) % 4)
        return at

    def points(self, points):
        at = len(self.bytes)
        size = 6 + 6 + 24 * len(points)
        padding = -size % 4
        packet = struct.pack("<BBHH", 1, 0, size + padding - 1, 3) + struct.pack("<HHH", *3 * [8 * len(points)])
        for axis in range(3):
            packet += struct.pack(f"<{len(points)}d", *(p[axis] for p in points))
        packet += bytes(padding)
        self.bytes += struct.pack("<QQQQ", 1, 32 + len(packet), place_in_file(at + 32), 0) + packet
        return place_in_file(at)

    def finished(self, xml):
        at = len(self.bytes)
        self.bytes += xml.encode()
        self.bytes += bytes(-len(self.bytes) % 1020)
        pages = len(self.bytes) // 1020
        self.bytes[:48] = struct.pack("<8sIIQQQQ", b"ASTM-E57", 1, 0, 1024 * pages, place_in_file(at), len(xml), 1024)
        out = b""
        for page in range(pages):
            data = bytes(self.bytes[1020 * page:1020 * (page + 1)])
            out += data + struct.pack(">I", crc32c(data))
        return out


def scan(file, guid, station, axes, directions):
    """A scan whose scanner is turned by `axes`; its points lie 3 m away."""
    own = [[3 * sum(d[k] * axis[k] for k in range(3)) for axis in axes] for d in directions]
    at = file.points(own)
    fields = "".join(f"<cartesian{n} type='Float'/>" for n in "XYZ")
    return (f"<vectorChild type='Structure'><guid type='String'>{guid}</guid>{pose(axes, station)}"
            f"<points type='CompressedVector' fileOffset='{at}' recordCount='{len(own)}'><prototype type='Structure'>"
            f"{fields}</prototype><codecs type='Vector'/></points></vectorChild>")


def camera(file, guid, station):
    """Looks to the north-east and a little down; 120 degrees wide."""
    forward = unit([1, 1.3, -0.1])
    right = unit(cross(forward, [0, 0, 1]))
    up = cross(right, forward)
    width, height, focal_px = 120, 80, 34.64
    rows = [[colour(combined((1, forward), ((column + 0.5 - width / 2) / focal_px, right),
                             ((height / 2 - row - 0.5) / focal_px, up)))
             for column in range(width)] for row in range(height)]
    image = png(rows)
    at = file.blob(image)
    backward = [-c for c in forward]
    pixel_m = 0.00001
    numbers = {"imageWidth": width, "imageHeight": height, "focalLength": focal_px * pixel_m, "pixelWidth": pixel_m,
               "pixelHeight": pixel_m, "principalPointX": width / 2, "principalPointY": height / 2}
    return (picture(guid, station, (right, up, backward), "pinhole", numbers, at, len(image)),
            (forward, right, up, width / 2 / focal_px, height / 2 / focal_px))


def panorama(file, guid, station):
    """All around and from the nadir to the zenith; its middle is the south-west by west."""
    middle = unit([-2, -1, 0])
    width, height = 144, 72
    step = 2 * math.pi / width
    rows = []
    for row in range(height):
        elevation = (height / 2 - row - 0.5) * step
        line = []
        for column in range(width):
            to_the_right = (column + 0.5 - width / 2) * step
            right = cross(middle, [0, 0, 1])
            flat = combined((math.cos(to_the_right), middle), (math.sin(to_the_right), right))
            line.append(colour(combined((math.cos(elevation), flat), (math.sin(elevation), [0, 0, 1]))))
        rows.append(line)
    image = png(rows)
    at = file.blob(image)
    left = cross([0, 0, 1], middle)
    numbers = {"imageWidth": width, "imageHeight": height, "pixelWidth": step, "pixelHeight": step}
    return picture(guid, station, (middle, left, [0, 0, 1]), "spherical", numbers, at, len(image))


def picture(guid, station, axes, kind, numbers, at, length):
    integers = ("imageWidth", "imageHeight")
    values = "".join(f"<{n} type='{'Integer' if n in integers else 'Float'}'>{v:.17g}</{n}>"
                     for n, v in numbers.items())
    return (f"<vectorChild type='Structure'><associatedData3DGuid type='String'>{guid}</associatedData3DGuid>"
            f"{pose(axes, station)}<{kind}Representation type='Structure'>{values}"
            f"<pngImage type='Blob' fileOffset='{at}' length='{length}'/></{kind}Representation></vectorChild>")


def directions_around(seed, count):
    """Directions that are well within their eighth of the sphere."""
    found = []
    state = seed
    while len(found) < count:
        numbers = []
        for _ in range(3):
            state = state * 6364136223846793005 + 1442695040888963407 & (1 << 64) - 1
            numbers.append((state >> 33) / 2 ** 31 * 2 - 1)
        if min(abs(c) for c in unit(numbers)) > 0.15:
            found.append(unit(numbers))
    return found


def main():
    name = sys.argv[1]
    file = File()
    stations = [[5.0, -2.0, 1.5], [-4.0, 7.0, 1.0]]
    xml_of_camera, (forward, right, up, half_width, half_height) = camera(file, "{one}", stations[0])
    xml_of_panorama = panorama(file, "{two}", stations[1])

    def along(a, b):
        return sum(x * y for x, y in zip(a, b))

    rows, scans = [], []
    for number, station in enumerate(stations):
        directions = directions_around(7 + number, 200)
        tilted = unit([0.1, -0.2, 1.0])
        side = unit(cross(tilted, [0.3, 1.0, 0.2]))
        scans.append(scan(file, ("{one}", "{two}")[number], station, (side, cross(tilted, side), tilted), directions))
        for d in directions:
            seen = True
            if number == 0:
                ahead = along(d, forward)
                across, above = abs(along(d, right)), abs(along(d, up))
                seen = ahead > 0 and across < half_width * ahead and above < half_height * ahead
            rows.append([*(s + 3 * c for s, c in zip(station, d)), int(seen), *colour(d)])
    xml = ("<?xml version='1.0'?><e57Root type='Structure'><data3D type='Vector'>" + "".join(scans)
           + "</data3D><images2D type='Vector'>" + xml_of_camera + xml_of_panorama + "</images2D></e57Root>")
    with open(name + ".e57", "wb") as out:
        out.write(file.finished(xml))
    with open(name + ".csv", "w", encoding="ascii") as out:
        for row in rows:
            out.write(",".join(f"{value:.17g}" for value in row) + "\n")


main()
