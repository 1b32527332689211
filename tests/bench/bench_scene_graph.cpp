// `full` against OpenSceneGraph drawing the same chunks from the same eye: see README.md. Frames of the two take turns,
// so that what else the machine does meets both alike.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <osg/CullFace>
#include <osg/Depth>
#include <osg/Geometry>
#include <osg/MatrixTransform>
#include <osg/PolygonOffset>
#include <osg/Program>
#include <osg/Texture2DArray>
#include <osg/Version>
#include <osgViewer/Viewer>

#include "tests/bench/bench_city.h"

namespace
{

const char *const vertex_text = R"(#version 130
uniform vec3 to_sun;
out vec3 uvl;
out vec4 tint;
out float clear;
void main()
{
	vec4 at = gl_ModelViewMatrix * gl_Vertex;
	gl_Position = gl_ProjectionMatrix * at;
	uvl = gl_MultiTexCoord0.xyz;
	tint = vec4(gl_Color.rgb * (0.45 + 0.75 * max(dot(gl_Normal, to_sun), 0.0)), 1.0);
	clear = exp2(-0.00035 * length(at.xyz));
})";

const char *const fragment_text = R"(#version 130
uniform sampler2DArray textures;
in vec3 uvl;
in vec4 tint;
in float clear;
void main()
{
	vec4 texel = texture(textures, uvl);
	gl_FragColor = vec4(mix(vec3(0.62, 0.71, 0.82), texel.rgb * sqrt(tint.rgb), clear), texel.a);
})";

osg::Image *layer_image(const bench_textures &textures, uint32_t layer)
{
	osg::Image::MipmapDataType offsets;
	size_t total = 0, level_start = 0;
	for (uint32_t level = 0; level < textures.levels; level++) {
		if (level)
			offsets.push_back(unsigned(total));
		total += size_t(std::max(1u, textures.width >> level)) * std::max(1u, textures.height >> level) * 4;
	}
	unsigned char *bytes = new unsigned char[total], *to = bytes;
	for (uint32_t level = 0; level < textures.levels; level++) {
		size_t size = size_t(std::max(1u, textures.width >> level)) * std::max(1u, textures.height >> level) * 4;
		std::memcpy(to, textures.texels + level_start + layer * size, size);
		to += size;
		level_start += size * textures.layers;
	}
	osg::Image *image = new osg::Image;
	image->setImage(int(textures.width), int(textures.height), 1, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, bytes,
		osg::Image::USE_NEW_DELETE);
	image->setMipmapLevels(offsets);
	return image;
}

osg::Texture2DArray *make_textures(const bench_textures &from)
{
	osg::Texture2DArray *array = new osg::Texture2DArray;
	array->setTextureSize(int(from.width), int(from.height), int(from.layers));
	for (uint32_t layer = 0; layer < from.layers; layer++)
		array->setImage(layer, layer_image(from, layer));
	array->setFilter(osg::Texture::MIN_FILTER, osg::Texture::LINEAR_MIPMAP_LINEAR);
	array->setFilter(osg::Texture::MAG_FILTER, osg::Texture::LINEAR);
	array->setWrap(osg::Texture::WRAP_S, osg::Texture::REPEAT);
	array->setWrap(osg::Texture::WRAP_T, osg::Texture::REPEAT);
	return array;
}

osg::StateSet *decal_state()
{
	osg::StateSet *state = new osg::StateSet;
	state->setRenderBinDetails(1, "RenderBin");
	state->setMode(GL_BLEND, osg::StateAttribute::ON);
	state->setAttributeAndModes(new osg::PolygonOffset(-1.0f, -16.0f));
	state->setAttributeAndModes(new osg::Depth(osg::Depth::LEQUAL, 0.0, 1.0, false));
	return state;
}

struct counted {
	uint32_t triangles = 0;
};

// Every drawable that is drawn is counted, so that both can be seen to draw the same.
struct count_callback : osg::Drawable::DrawCallback {
	counted *sum;
	uint32_t triangles;
	count_callback(counted *s, uint32_t n) : sum(s), triangles(n)
	{
	}
	void drawImplementation(osg::RenderInfo &info, const osg::Drawable *drawable) const override
	{
		sum->triangles += triangles;
		drawable->drawImplementation(info);
	}
};

osg::Node *make_chunk(const bench_chunk &from, osg::StateSet *decals, counted *sum)
{
	unsigned n = from.vertices;
	osg::ref_ptr<osg::Vec3Array> positions = new osg::Vec3Array(n, reinterpret_cast<const osg::Vec3 *>(from.positions));
	osg::ref_ptr<osg::Vec3Array> normals = new osg::Vec3Array(n, reinterpret_cast<const osg::Vec3 *>(from.normals));
	osg::ref_ptr<osg::Vec3Array> uvs = new osg::Vec3Array(n, reinterpret_cast<const osg::Vec3 *>(from.uvs));
	osg::ref_ptr<osg::Vec4ubArray> colors = new osg::Vec4ubArray(n, reinterpret_cast<const osg::Vec4ub *>(from.colors));
	colors->setNormalize(true);
	osg::MatrixTransform *transform =
		new osg::MatrixTransform(osg::Matrix::translate(from.origin_m[0], from.origin_m[1], from.origin_m[2]));
	for (int pass = 0; pass < 2; pass++) {
		if (!from.index_count[pass])
			continue;
		osg::Geometry *geometry = new osg::Geometry;
		geometry->setUseDisplayList(false);
		geometry->setUseVertexBufferObjects(true);
		geometry->setVertexArray(positions);
		geometry->setNormalArray(normals, osg::Array::BIND_PER_VERTEX);
		geometry->setColorArray(colors, osg::Array::BIND_PER_VERTEX);
		geometry->setTexCoordArray(0, uvs);
		geometry->addPrimitiveSet(
			new osg::DrawElementsUShort(GL_TRIANGLES, from.index_count[pass], from.indices[pass]));
		geometry->setDrawCallback(new count_callback(sum, from.index_count[pass] / 3));
		if (pass)
			geometry->setStateSet(decals);
		transform->addChild(geometry);
	}
	return transform;
}

osg::ref_ptr<osg::Group> make_scene(bench_city *city, counted *sum)
{
	bench_textures textures;
	bench_eye eye;
	if (!bench_texture_view(city, &textures))
		return nullptr;
	bench_eye_view(city, &eye);
	osg::ref_ptr<osg::Group> root = new osg::Group;
	osg::StateSet *state = root->getOrCreateStateSet();
	osg::ref_ptr<osg::Program> program = new osg::Program;
	program->addShader(new osg::Shader(osg::Shader::VERTEX, vertex_text));
	program->addShader(new osg::Shader(osg::Shader::FRAGMENT, fragment_text));
	state->setAttributeAndModes(program);
	state->setAttributeAndModes(new osg::CullFace(osg::CullFace::BACK));
	state->setTextureAttribute(0, make_textures(textures));
	state->addUniform(new osg::Uniform("textures", 0));
	state->addUniform(new osg::Uniform("to_sun", osg::Vec3(eye.to_sun[0], eye.to_sun[1], eye.to_sun[2])));
	osg::ref_ptr<osg::StateSet> decals = decal_state();
	for (uint32_t i = 0; i < bench_chunk_count(city); i++) {
		bench_chunk chunk;
		if (!bench_chunk_make(city, i, &chunk))
			return nullptr;
		root->addChild(make_chunk(chunk, decals, sum));
		bench_chunk_free(&chunk);
	}
	return root;
}

// A multisampled framebuffer, resolved and read back at the end: what boulevard's frame does. By hand, as
// OpenSceneGraph's own is refused by llvmpipe.
struct target : osg::Referenced {
	osg::ref_ptr<osg::Image> image;
	int samples;
	GLuint drawn = 0, resolved = 0;
	target(osg::Image *to, unsigned n) : image(to), samples(int(n))
	{
	}

	GLuint make(osg::GLExtensions *gl, int count, bool depth)
	{
		GLuint framebuffer, names[2];
		gl->glGenFramebuffers(1, &framebuffer);
		gl->glBindFramebuffer(GL_FRAMEBUFFER_EXT, framebuffer);
		gl->glGenRenderbuffers(2, names);
		for (int i = 0; i < (depth ? 2 : 1); i++) {
			gl->glBindRenderbuffer(GL_RENDERBUFFER_EXT, names[i]);
			gl->glRenderbufferStorageMultisample(
				GL_RENDERBUFFER_EXT, count, i ? GL_DEPTH_COMPONENT24 : GL_RGBA8, image->s(), image->t());
			gl->glFramebufferRenderbuffer(GL_FRAMEBUFFER_EXT, i ? GL_DEPTH_ATTACHMENT_EXT : GL_COLOR_ATTACHMENT0_EXT,
				GL_RENDERBUFFER_EXT, names[i]);
		}
		return framebuffer;
	}
	void begin(osg::GLExtensions *gl)
	{
		if (!drawn) {
			resolved = make(gl, 0, false);
			drawn = make(gl, samples, true);
		}
		gl->glBindFramebuffer(GL_FRAMEBUFFER_EXT, drawn);
		glDrawBuffer(GL_COLOR_ATTACHMENT0_EXT);
	}
	void end(osg::GLExtensions *gl)
	{
		int w = image->s(), h = image->t();
		gl->glBindFramebuffer(GL_READ_FRAMEBUFFER_EXT, drawn);
		gl->glBindFramebuffer(GL_DRAW_FRAMEBUFFER_EXT, resolved);
		gl->glBlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT, GL_NEAREST);
		gl->glBindFramebuffer(GL_FRAMEBUFFER_EXT, resolved);
		glReadBuffer(GL_COLOR_ATTACHMENT0_EXT);
		glReadPixels(0, 0, w, h, GL_RGBA, GL_UNSIGNED_BYTE, image->data());
		gl->glBindFramebuffer(GL_FRAMEBUFFER_EXT, 0);
	}
};

struct begin_callback : osg::Camera::DrawCallback {
	osg::ref_ptr<target> to;
	explicit begin_callback(target *t) : to(t)
	{
	}
	void operator()(osg::RenderInfo &info) const override
	{
		to->begin(info.getState()->get<osg::GLExtensions>());
	}
};
struct end_callback : osg::Camera::DrawCallback {
	osg::ref_ptr<target> to;
	explicit end_callback(target *t) : to(t)
	{
	}
	void operator()(osg::RenderInfo &info) const override
	{
		to->end(info.getState()->get<osg::GLExtensions>());
	}
};

bool set_camera(osgViewer::Viewer &viewer, bench_city *city, const bench_options &options, osg::Image *image)
{
	osg::ref_ptr<osg::GraphicsContext::Traits> traits = new osg::GraphicsContext::Traits;
	traits->readDISPLAY();
	traits->setUndefinedScreenDetailsToDefaultScreen();
	traits->width = int(options.width);
	traits->height = int(options.height);
	traits->pbuffer = true;
	osg::ref_ptr<osg::GraphicsContext> context = osg::GraphicsContext::createGraphicsContext(traits);
	if (!context)
		return false;
	bench_eye eye;
	bench_eye_view(city, &eye);
	osg::Vec3d at(eye.at_m[0], eye.at_m[1], eye.at_m[2]), forward(eye.forward[0], eye.forward[1], eye.forward[2]);
	osg::Camera *camera = viewer.getCamera();
	camera->setGraphicsContext(context);
	camera->setViewport(0, 0, int(options.width), int(options.height));
	camera->setViewMatrixAsLookAt(at, at + forward, osg::Vec3d(eye.up[0], eye.up[1], eye.up[2]));
	camera->setProjectionMatrixAsPerspective(
		eye.fov_y_deg, double(options.width) / options.height, eye.near_m, eye.far_m);
	camera->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
	camera->setCullingMode(osg::CullSettings::VIEW_FRUSTUM_CULLING); // nothing is left out for being small
	camera->setClearColor(osg::Vec4(0.62f, 0.71f, 0.82f, 1.0f));
	camera->setDrawBuffer(GL_COLOR_ATTACHMENT0_EXT);
	osg::ref_ptr<target> into = new target(image, options.samples > 1 ? options.samples : 0);
	camera->setInitialDrawCallback(new begin_callback(into));
	camera->setFinalDrawCallback(new end_callback(into));
	return true;
}

double median_ms(std::vector<int64_t> values)
{
	std::sort(values.begin(), values.end());
	return double(values[values.size() / 2]) * 1e-6;
}

void save(const char *path, const uint8_t *pixels, const bench_options &options, bool bottom_up)
{
	std::vector<uint8_t> rows(size_t(options.width) * options.height * 4);
	for (uint32_t y = 0; y < options.height; y++)
		std::memcpy(&rows[size_t(y) * options.width * 4],
			pixels + size_t(bottom_up ? options.height - 1 - y : y) * options.width * 4, size_t(options.width) * 4);
	bench_write_png(path, rows.data(), options.width, options.height);
}

int compare(bench_city *city, const bench_options &options, int frames, const char *pictures)
{
	counted sum;
	osgViewer::Viewer viewer;
	osg::ref_ptr<osg::Image> image = new osg::Image;
	image->allocateImage(int(options.width), int(options.height), 1, GL_RGBA, GL_UNSIGNED_BYTE);
	osg::ref_ptr<osg::Group> scene = make_scene(city, &sum);
	if (!scene || !set_camera(viewer, city, options, image)) {
		std::fprintf(stderr, "no scene graph: is there an X server?\n");
		return 1;
	}
	viewer.setThreadingModel(osgViewer::ViewerBase::SingleThreaded);
	viewer.setReleaseContextAtEndOfFrameHint(true);
	viewer.setLightingMode(osg::View::NO_LIGHT);
	viewer.setCameraManipulator(nullptr);
	viewer.setSceneData(scene);
	viewer.realize();
	for (int i = 0; i < 3; i++)
		viewer.frame(); // compiles, uploads

	std::vector<int64_t> ours, theirs;
	for (int i = 0; i < frames; i++) {
		ours.push_back(bench_boulevard_frame(city));
		int64_t start = bench_cpu_ns();
		sum.triangles = 0;
		viewer.frame();
		theirs.push_back(bench_cpu_ns() - start);
	}
	double a = median_ms(ours), b = median_ms(theirs);
	std::printf("%ux%u, %u samples, %d frames each, in turns; medians of CPU time\n", options.width, options.height,
		options.samples, frames);
	std::printf("boulevard           %8.2f ms  %u triangles\n", a, bench_boulevard_triangles(city));
	std::printf("OpenSceneGraph %s %8.2f ms  %u triangles\n", osgGetVersion(), b, sum.triangles);
	std::printf("ratio %.2f\n", a / b);
	if (pictures) {
		save((std::string(pictures) + "_boulevard.png").c_str(), bench_boulevard_pixels(city), options, false);
		save((std::string(pictures) + "_osg.png").c_str(), image->data(), options, true);
	}
	return 0;
}

} // namespace

int main(int argc, char **argv)
{
	bench_options options = {};
	options.width = 1280;
	options.height = 720;
	options.samples = argc > 3 ? uint32_t(std::atoi(argv[3])) : 1;
	int frames = argc > 4 ? std::atoi(argv[4]) : 15;
	if (argc < 3 || frames < 1 ||
		std::sscanf(argv[2], "%lf,%lf,%lf", &options.east_m, &options.north_m, &options.heading_deg) != 3) {
		std::fprintf(stderr, "usage: %s CITY.blvd EAST,NORTH,HEADING [SAMPLES [FRAMES [PICTURES]]]\n", argv[0]);
		return 2;
	}
	options.package = argv[1];
	bench_city *city = bench_open(&options);
	if (!city)
		return 1;
	int status = compare(city, options, frames, argc > 5 ? argv[5] : nullptr);
	bench_close(city);
	return status;
}
