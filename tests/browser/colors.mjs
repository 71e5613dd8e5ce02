// Clouds in the colours of their sculpts in the page of `cloudbake view` beside the pictures of `preview`.
//   node tests/browser/colors.mjs CLOUDBAKE SOURCE_FOLDER
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import { after, canvasValues, compare, demand, percent, pngValues, settled, testFolder, testPage } from './browser.mjs';
import { changedGlb } from './glb.mjs';

const { folder, run, open } = testFolder(), SIZE = [320, 200], BOUND = 0.998;
const HEAD = '[picture]\nwidth = 320\nheight = 200\ntime = 30\n[camera]\nposition = [0, 1, 7]\ntarget = [0, 0.3, 0]\nfov = 40\n' +
  '[sun]\nazimuth = 130\nelevation = 30\n';
const CLOUDS = "[[cloud]]\nfile = 'colored.glb'\nposition = [-1, 0, 0]\n" +
  "[[cloud]]\nfile = 'colored.glb'\nposition = [1.2, 0.4, -1]\nrotation = [0, 50, 0]\nscale = 0.7\n" +
  "[[cloud]]\nfile = 'white.glb'\nposition = [0.3, 0.8, -1.5]\nscale = 0.25\n";
const LAMP = '[[lamp]]\nplace = [0, 0.5, 1.5]\ncolor = [1, 0.5, 0.2]\nstrength = 3\nradius = 0.3\n';
const FIELD = "[[cloud]]\nfile = 'colored.glb'\nscale = 0.6\n[cloud.scatter]\nlow = [-3, -1, -4]\nhigh = [3, 2, 2]\ncount = 9\n";
const SCENES = {
  clouds: HEAD + CLOUDS,
  'clouds and a lamp': HEAD + LAMP + CLOUDS,
  published: `${HEAD}[chain]\nas_published = true\n${CLOUDS}`,
  'published, darkened, a mean over all': `${HEAD}[chain]\nas_published = true\nmean = 'all'\ndark = 0.6\n${CLOUDS}`,
  field: `${HEAD}[light]\nshadows = false\n${FIELD}`,  // the page's shadows of fields are coarser
  'a field and white clouds': `${HEAD}[light]\nshadows = false\n${FIELD}[[cloud]]\nfile = 'white.glb'\nscale = 0.5\n`,
  'over terrain': `${HEAD}[terrain]\nscale = 0.03\norigin = [30, -4.6, 10]\n${CLOUDS}`,
};

// An OBJ of a ball with bumps: red to green from left to right and blue in stripes, or with a texture over it.
function ballText(material) {
  const columns = 64, rows = 32, lines = [], faces = [], at = (row, column) => 2 + (row - 1) * columns + column % columns;
  const add = (x, y, z) => {
    const r = 1 + 0.12 * Math.sin(7 * x) * Math.sin(6 * y + 1) * Math.sin(5 * z + 2), place = [x, y, z].map(c => (c * r).toFixed(6));
    const own = [0.5 - 0.45 * x, 0.5 + 0.45 * x, y * 8 % 1 > 0 ? 0.8 : 0.1];
    lines.push(`v ${[...place, ...material ? [] : own.map(c => c.toFixed(4))].join(' ')}`);
    lines.push(`vt ${(1.7 * x).toFixed(6)} ${(0.9 * y).toFixed(6)}`);
  };
  add(0, 1, 0);
  for (let row = 1; row < rows; ++row)
    for (let column = 0; column < columns; ++column) {
      const theta = Math.PI * row / rows, phi = 2 * Math.PI * column / columns;
      add(Math.sin(theta) * Math.sin(phi), Math.cos(theta), Math.sin(theta) * Math.cos(phi));
    }
  add(0, -1, 0);
  const last = lines.length / 2;
  for (let column = 0; column < columns; ++column) {
    faces.push([1, at(1, column), at(1, column + 1)], [last, at(rows - 1, column + 1), at(rows - 1, column)]);
    for (let row = 1; row < rows - 1; ++row)
      faces.push([at(row, column), at(row + 1, column), at(row + 1, column + 1)],
        [at(row, column), at(row + 1, column + 1), at(row, column + 1)]);
  }
  const head = material ? ['mtllib ball.mtl', 'usemtl painted'] : [];
  return `${[...head, ...lines, ...faces.map(face => `f ${face.map(v => `${v}/${v}`).join(' ')}`)].join('\n')}\n`;
}

async function isThatOfPreview(page, name, right) {
  const { near } = compare(await canvasValues(page), right);
  demand(near >= BOUND, `${name}: ${percent(near)} of values are within 1 of preview's (at least ${percent(BOUND)})`);
  const { near: white } = compare(await after(page, 'this.renderer.look.own_colors = false, this.change({})'), right);
  demand(white < 0.97, `${name}, in white: only ${percent(white)}`);
}

async function scenesAreThoseOfPreview(page) {
  for (const [name, text] of Object.entries(SCENES)) {
    writeFileSync(join(folder, 'scene.toml'), text);
    run('view', '--scene', 'scene.toml', '-o', 'page.html');
    run('preview', '--scene', 'scene.toml', '--size', SIZE.join('x'), '-o', 'picture.png');
    await open(page, 'page.html', `ui=0&size=${SIZE.join('x')}`);
    await isThatOfPreview(page, name, await pngValues(page, join(folder, 'picture.png')));
  }
}

async function assetsAreThoseOfPreview(page) {
  for (const look of ['plain', 'painted']) {
    run('preview', 'colored.glb', '--look', look, '--size', SIZE.join('x'), '-o', 'picture.png');
    run('view', 'colored.glb', '--look', look, '-o', 'page.html');
    await open(page, 'page.html', `ui=0&size=${SIZE.join('x')}`);
    await isThatOfPreview(page, `an asset, ${look}`, await pngValues(page, join(folder, 'picture.png')));
  }
}

// Opened by the program and dropped on the page of another cloud.
async function filesAreThoseOfPreview(page) {
  const size = SIZE.join('x'), changed = (name, change) =>
    writeFileSync(join(folder, name), changedGlb(readFileSync(join(folder, 'textured.glb')), change));
  run('preview', 'white.glb', '--size', '48x32', '-o', 'texture.png');
  writeFileSync(join(folder, 'ball.mtl'), 'newmtl painted\nKd 0.9 0.7 0.2\nmap_Kd texture.png\n');
  writeFileSync(join(folder, 'textured.obj'), ballText('painted'));
  run('bake', 'textured.obj', '--rays', '64', '-o', 'textured.glb');
  changed('turned.glb', json => {
    json.samplers = [{ wrapS: 33648, wrapT: 33071 }];
    json.textures[0].sampler = 0;
    json.materials[0].pbrMetallicRoughness.baseColorTexture.extensions =
      { KHR_texture_transform: { offset: [0.3, 0.1], scale: [1.5, 0.7], rotation: 0.6 } };
  });
  changed('grey.glb', json => { json.materials = [{ pbrMetallicRoughness: { baseColorFactor: [0.8, 0.8, 0.8, 1] } }]; });
  changed('lost.glb', json => { json.images[0] = { uri: 'lost.png' }; });
  for (const name of ['colored', 'textured', 'turned', 'grey', 'lost']) {
    run('preview', `${name}.glb`, '--size', size, '-o', 'picture.png');
    run('view', `${name}.glb`, '-o', 'page.html');
    run('view', name === 'colored' ? 'textured.glb' : 'colored.glb', '-o', 'other.html');
    await open(page, 'page.html', `ui=0&size=${size}`);
    const right = await pngValues(page, join(folder, 'picture.png'));
    const shareOfCanvas = async () => compare(await canvasValues(page), right).near;
    const opened = await shareOfCanvas();
    await open(page, 'other.html', `ui=0&size=${size}`);
    const other = await shareOfCanvas(), told = await page.evaluate(async ([bytes, file]) => {
      const { viewer } = window, { camera, view } = viewer.scene;
      await viewer.open(new File([Uint8Array.from(atob(bytes), c => c.charCodeAt(0))], file));
      Object.assign(viewer.scene, { camera, view });  // the page chooses its own
      viewer.setState(viewer.homeOf(viewer.scene));
      return document.getElementById('message-text').textContent;
    }, [readFileSync(join(folder, `${name}.glb`)).toString('base64'), `${name}.glb`]);
    await settled(page);
    const dropped = await shareOfCanvas();
    demand(opened >= BOUND && dropped >= BOUND && other < 0.97,
      `${name}: ${percent(opened)} within 1 of preview's, dropped on another page ${percent(dropped)}, before it only ${percent(other)}`);
    demand(told.includes('material 0: its texture cannot be read') === (name === 'lost'), `${name} says: ${told || 'nothing'}`);
  }
}

await testPage(folder, async page => {
  writeFileSync(join(folder, 'colored.obj'), ballText());
  run('bake', 'colored.obj', '--rays', '64', '-o', 'colored.glb');
  run('grow', 'hero', '--vertices', '3000', '--rays', '64', '--voxels', '60', '-o', 'white.glb');
  await scenesAreThoseOfPreview(page);
  await assetsAreThoseOfPreview(page);
  await filesAreThoseOfPreview(page);
});
