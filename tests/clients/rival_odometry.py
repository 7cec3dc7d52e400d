"""RGB-D odometry and the alignment of depth as they are put together from OpenCV and Open3D, for compare_motion.py.

Every estimator is asked for `world_from_sensor` of one frame after the other: 4 × 4, metres, None where it lost its way. Depth is
a picture of single precision in metres, seen by the colour camera, 0 where nothing was measured. All of them are at their best
here: their parameters were tried out on the simulated room, which is more than a user can do.
"""

import cv2
import numpy

try:
    import open3d
except (ImportError, OSError) as error:
    open3d = None
    WITHOUT_OPEN3D = str(error).splitlines()[0]

# Noise of a Kinect's depth, m at a distance of 1 m; it grows with the square. Seen as disparity it is the same everywhere, so one
# threshold in pixels serves points at all distances.
DEPTH_STD_M = 1.425e-3
NEAREST_M, FARTHEST_M = 0.4, 8.0
LEAST_INLIERS = 15


def inverse(pose):
    rotation = pose[:3, :3].T
    return numpy.block([[rotation, -rotation @ pose[:3, 3:]], [numpy.zeros((1, 3)), 1.0]])


class Registration:
    """Depth to colour by OpenCV's registerDepth."""

    def __init__(self, camera):
        self.unit_m = 1.0 / camera["depth_scale"]
        self.size = (camera["color"]["width"], camera["color"]["height"])
        self.of_depth, self.of_color = matrix_of(camera["depth"]), matrix_of(camera["color"])
        self.color_from_depth = pose_of(camera["color_from_depth"])
        # Whole numbers are taken for millimetres; so lengths are given in thousands of what the depth counts.
        self.color_from_depth[:3, 3] *= 1e-6 / self.unit_m

    def units(self, depth, is_dilated=True):
        """The aligned picture, in whole units of the depth camera's."""
        return cv2.rgbd.registerDepth(
            self.of_depth, self.of_color, numpy.empty(0), self.color_from_depth, depth, self.size, depthDilation=is_dilated
        )

    def metres(self, depth):
        aligned = self.units(depth).astype(numpy.float32) * numpy.float32(self.unit_m)
        aligned[(aligned < NEAREST_M) | (aligned > FARTHEST_M)] = 0.0
        return aligned


def matrix_of(intrinsics):
    return numpy.array(
        [[intrinsics["fx"], 0.0, intrinsics["cx"]], [0.0, intrinsics["fy"], intrinsics["cy"]], [0.0, 0.0, 1.0]]
    )


def pose_of(entry):
    """4 × 4, in mm, of what session and camera files hold."""
    w, *v = entry["quaternion_wxyz"]
    x, y, z = v
    pose = numpy.eye(4)
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    pose[:3, :3] = numpy.eye(3) + 2 * w * cross + 2 * cross @ cross
    pose[:3, 3] = entry["translation_mm"]
    return pose


def depth_at(depth, pixels):
    """The mean depth of the 3 × 3 pixels about each place; 0 where half of them are missing, or more than noise is between them."""
    height, width = depth.shape
    columns, rows = numpy.rint(pixels).astype(int).T
    is_inside = (columns > 0) & (columns < width - 1) & (rows > 0) & (rows < height - 1)
    columns, rows = numpy.clip(columns, 1, width - 2), numpy.clip(rows, 1, height - 2)
    around = numpy.stack([depth[rows + dv, columns + du] for dv in (-1, 0, 1) for du in (-1, 0, 1)])
    is_seen = around > 0
    num_seen = is_seen.sum(axis=0)
    mean = around.sum(axis=0) / numpy.maximum(num_seen, 1)
    span = around.max(axis=0) - numpy.where(is_seen, around, numpy.inf).min(axis=0)
    is_smooth = span < 6 * DEPTH_STD_M * mean**2 + 0.02 * mean
    return numpy.where(is_inside & (num_seen >= 5) & is_smooth, mean, 0.0)


def points_at(pixels, depths, camera_matrix):
    rays = numpy.column_stack([pixels, numpy.ones(len(pixels))]) @ numpy.linalg.inv(camera_matrix).T
    return rays * depths[:, None]


def pose_from_points(points, pixels, camera_matrix, threshold_px):
    """`now_from_keyframe` by random samples, then least squares over those that agree, twice; and how many do."""
    if len(points) < LEAST_INLIERS:
        return None, 0
    found, turn, shift, inliers = cv2.solvePnPRansac(
        points, pixels, camera_matrix, None, iterationsCount=200, reprojectionError=threshold_px, confidence=0.999,
        flags=cv2.SOLVEPNP_AP3P,
    )  # fmt: skip
    if not found or inliers is None or len(inliers) < LEAST_INLIERS:
        return None, 0
    agree = inliers.ravel()
    for _ in range(2):
        turn, shift = cv2.solvePnPRefineLM(points[agree], pixels[agree], camera_matrix, None, turn, shift)
        again = cv2.projectPoints(points, turn, shift, camera_matrix, None)[0].reshape(-1, 2)
        off = numpy.linalg.norm(again - pixels, axis=1)
        agree = numpy.flatnonzero(off < threshold_px)
        if len(agree) < LEAST_INLIERS:
            return None, 0
    pose = numpy.eye(4)
    pose[:3, :3], pose[:3, 3] = cv2.Rodrigues(turn)[0], shift.ravel()
    return pose, len(agree)


class Tracker:
    """What the estimators by points share: a keyframe, the pose relative to it, and the motion to expect."""

    def __init__(self, camera_matrix):
        self.camera_matrix = camera_matrix
        self.world_from_keyframe = numpy.eye(4)
        self.now_from_keyframe = numpy.eye(4)
        self.now_from_previous = numpy.eye(4)
        self.points = None

    def pose(self, color, depth):
        grey = cv2.cvtColor(color, cv2.COLOR_BGR2GRAY)
        if self.points is None:
            self.start_keyframe(grey, depth)
            return self.world_from_keyframe
        pose, num_agree = self.motion(grey, self.now_from_previous @ self.now_from_keyframe)
        if pose is None:
            self.now_from_previous = numpy.eye(4)
            return None
        self.now_from_previous = pose @ inverse(self.now_from_keyframe)
        self.now_from_keyframe = pose
        world_from_now = self.world_from_keyframe @ inverse(pose)
        if num_agree < self.LEAST_PART * len(self.points):
            self.world_from_keyframe, self.now_from_keyframe = world_from_now, numpy.eye(4)
            self.start_keyframe(grey, depth)
        return world_from_now


class KltPnp(Tracker):
    """Corners of a keyframe, followed by Lucas and Kanade from where they are expected, there and back; then PnP."""

    LEAST_PART = 0.9
    WINDOW = {"winSize": (15, 15), "maxLevel": 2, "criteria": (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 30, 0.003)}
    THERE_AND_BACK_PX = 0.3
    THRESHOLD_PX = 1.0

    def start_keyframe(self, grey, depth):
        mask = (depth > 0).astype(numpy.uint8)
        corners = cv2.goodFeaturesToTrack(grey, maxCorners=600, qualityLevel=0.005, minDistance=12, mask=mask, blockSize=5)
        corners = numpy.empty((0, 2), numpy.float32) if corners is None else corners.reshape(-1, 2)
        depths = depth_at(depth, corners)
        self.corners = corners[depths > 0]
        self.points = points_at(self.corners, depths[depths > 0], self.camera_matrix)
        self.grey = grey

    def motion(self, grey, expected):
        turn, shift = cv2.Rodrigues(expected[:3, :3])[0], expected[:3, 3]
        start = cv2.projectPoints(self.points, turn, shift, self.camera_matrix, None)[0].reshape(-1, 2).astype(numpy.float32)
        flags = cv2.OPTFLOW_USE_INITIAL_FLOW
        there, found, _ = cv2.calcOpticalFlowPyrLK(self.grey, grey, self.corners, start, flags=flags, **self.WINDOW)
        back, found_back, _ = cv2.calcOpticalFlowPyrLK(
            grey, self.grey, there, self.corners.copy(), flags=flags, **self.WINDOW
        )
        off = numpy.linalg.norm(back - self.corners, axis=1)
        good = (found.ravel() == 1) & (found_back.ravel() == 1) & (off < self.THERE_AND_BACK_PX)
        pixels = there[good].astype(numpy.float64)
        return pose_from_points(self.points[good], pixels, self.camera_matrix, self.THRESHOLD_PX)


class OrbPnp(Tracker):
    """ORB features, mutual nearest neighbours of a keyframe's, then PnP."""

    LEAST_PART = 0.45
    THRESHOLD_PX = 3.0
    FARTHEST_BITS = 60

    def __init__(self, camera_matrix):
        super().__init__(camera_matrix)
        self.orb = cv2.ORB_create(nfeatures=1500, nlevels=3, fastThreshold=10)
        self.matcher = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True)

    def look(self, grey):
        corners, self.words = self.orb.detectAndCompute(grey, None)
        self.corners = numpy.array([corner.pt for corner in corners], numpy.float64).reshape(-1, 2)

    def start_keyframe(self, grey, depth):
        if self.points is None:
            self.look(grey)
        depths = depth_at(depth, self.corners)
        self.known = self.words[depths > 0]
        self.points = points_at(self.corners[depths > 0], depths[depths > 0], self.camera_matrix)

    def motion(self, grey, _):
        self.look(grey)
        if self.words is None:
            return None, 0
        matches = [match for match in self.matcher.match(self.known, self.words) if match.distance <= self.FARTHEST_BITS]
        points = self.points[[match.queryIdx for match in matches]]
        pixels = self.corners[[match.trainIdx for match in matches]]
        return pose_from_points(points, pixels, self.camera_matrix, self.THRESHOLD_PX)


class Dense:
    """What the estimators by all pixels share: from frame to frame, started with the motion before."""

    def __init__(self, camera_matrix):
        self.camera_matrix = camera_matrix
        self.world_from_previous = numpy.eye(4)
        self.now_from_previous = numpy.eye(4)
        self.previous = None

    def pose(self, color, depth):
        now = self.prepared(color, depth)
        previous, self.previous = self.previous, now
        if previous is not None:
            self.now_from_previous = self.motion(previous, now, self.now_from_previous)
            self.world_from_previous = self.world_from_previous @ inverse(self.now_from_previous)
        return self.world_from_previous


class OpencvRgbd(Dense):
    """Steinbrücker's method in OpenCV's contributed modules."""

    def __init__(self, camera_matrix):
        super().__init__(camera_matrix)
        self.odometry = cv2.rgbd.RgbdOdometry_create(camera_matrix, 0.4, 5.0, 0.07)

    def prepared(self, color, depth):
        depth = numpy.where(depth > 0, depth, numpy.float32(numpy.nan))
        return cv2.rgbd.OdometryFrame_create(cv2.cvtColor(color, cv2.COLOR_BGR2GRAY), depth)

    def motion(self, previous, now, expected):
        found, motion = self.odometry.compute2(previous, now, None, expected)
        return motion if found else expected


class Open3dHybrid(Dense):
    """Open3D's multi-scale odometry over brightness and depth."""

    FARTHEST_M = 5.0

    def prepared(self, color, depth):
        color = cv2.cvtColor(color, cv2.COLOR_BGR2RGB)
        image = open3d.t.geometry.Image
        return open3d.t.geometry.RGBDImage(image(open3d.core.Tensor(color)), image(open3d.core.Tensor(depth)))

    def motion(self, previous, now, expected):
        odometry = open3d.t.pipelines.odometry
        result = odometry.rgbd_odometry_multi_scale(
            previous, now, open3d.core.Tensor(self.camera_matrix), open3d.core.Tensor(expected), 1.0, self.FARTHEST_M,
            [odometry.OdometryConvergenceCriteria(num) for num in (10, 5, 3)], odometry.Method.Hybrid,
        )  # fmt: skip
        return result.transformation.numpy()
