// numbers.h - the numbers of a model, for kernels over arrays (arrays.h) that read them as a scene's.
#define NUMBERS __constant const scalar *numbers
FN scene_data of_numbers(__constant const scalar *numbers)
{
  scene_data scene = {numbers, 0, 0, 0, 0};
  return scene;
}
