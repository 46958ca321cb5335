// Answers the rays that `examples/rays.rs --dump` wrote with Embree 3, for comparison:
//   cargo run --release --example rays -- 100000 --dump rays.bin
//   g++ -O3 -march=native embree.cpp -lembree3 -o embree && ./embree rays.bin
// Both programs answer the same rays against the same triangles, one ray at a time on one core,
// and print the best of five rounds in CPU time. The scene is built as Embree is meant to be
// used for rays that must not pass between triangles: robust, in high quality.

#include <embree3/rtcore.h>

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <limits>
#include <vector>

struct Ray {
    float origin[3], direction[3], t_max;
};

template <typename T> static std::vector<T> read_counted(FILE* file) {
    uint32_t count = 0;
    if (fread(&count, sizeof count, 1, file) != 1) return {};
    std::vector<T> items(count);
    if (fread(items.data(), sizeof(T), count, file) != count) items.clear();
    return items;
}

static double cpu_seconds() {
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

template <typename T> static void set(T& to, const Ray& ray) {
    to.org_x = ray.origin[0], to.org_y = ray.origin[1], to.org_z = ray.origin[2];
    to.dir_x = ray.direction[0], to.dir_y = ray.direction[1], to.dir_z = ray.direction[2];
    to.tnear = 0, to.tfar = ray.t_max, to.time = 0, to.mask = -1, to.id = 0, to.flags = 0;
}

int main(int argc, char** argv) {
    FILE* file = argc > 1 ? fopen(argv[1], "rb") : nullptr;
    if (!file) return fprintf(stderr, "usage: embree FILE\n"), 2;
    struct Triangle {
        float corners[9];
    };
    auto triangles = read_counted<Triangle>(file);
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices =
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 3 * triangles.size());
    memcpy(vertices, triangles.data(), sizeof(Triangle) * triangles.size());
    auto* indices = static_cast<uint32_t*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles.size()));
    for (uint32_t i = 0; i < 3 * triangles.size(); i++) indices[i] = i;
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    double start = cpu_seconds();
    rtcCommitScene(scene);
    printf("%zu triangles, built in %.2f CPU s\n", triangles.size(), cpu_seconds() - start);

    const char* kinds[] = {"camera", "bounce", "shadow"};
    for (int kind = 0; kind < 3; kind++) {
        auto rays = read_counted<Ray>(file);
        double best = std::numeric_limits<double>::infinity(), sum = 0;
        for (int round = 0; round < 5; round++) {
            sum = 0;
            start = cpu_seconds();
            for (const Ray& ray : rays) {
                RTCIntersectContext context;
                rtcInitIntersectContext(&context);
                context.flags =
                    kind == 0 ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
                if (kind == 2) {
                    RTCRay any;
                    set(any, ray);
                    rtcOccluded1(scene, &context, &any);
                    sum += any.tfar < 0;
                } else {
                    RTCRayHit nearest;
                    set(nearest.ray, ray);
                    nearest.hit.geomID = RTC_INVALID_GEOMETRY_ID;
                    rtcIntersect1(scene, &context, &nearest);
                    if (nearest.hit.geomID != RTC_INVALID_GEOMETRY_ID) sum += nearest.ray.tfar;
                }
            }
            double seconds = cpu_seconds() - start;
            if (seconds < best) best = seconds;
        }
        printf("%s %.3f Mrays/s, %zu rays, sum %.6f\n", kinds[kind], rays.size() / best * 1e-6, rays.size(), sum);
    }
}
