// The keys of a scene file whose values can be changed in the page.

/** A name of the file as words. */
export const plainName = name => (name[0].toUpperCase() + name.slice(1)).replaceAll('_', ' ');

/** The unit that the help of a key names, which follows a comma. */
export const unitIn = help => help.match(/, ((?:world )?units|degrees|pixels|seconds|(?:units|cells) per second)(?![^;,:.])/)?.[1];

// The titles of tables that occur several times in a file are in double brackets.
const REPEATED = { slabs: '[slab]', distance: '[marched]', density: '[marched]', dust: '[dust]' };

// The tables of a scene file of the settings that scene.layers.limits[table] names, each as [title, id, path in scene.layers].
function tablesOfLayers(layers, table) {
  if (REPEATED[table]) return layers[table].map((_, i) => [REPEATED[table], `${table}.${i}`, [table, i]]);
  const title = table.startsWith('grade.') ? 'grade' : table;
  return [[title, title, table === 'sky' ? ['sky', 'smooth_disc'] : table.split('.')]];
}

/**
 * By table: its title in the scene file, an id of its own, and its keys, each with the object and the place there of its value, and its
 * limits.
 * @param {Scene} scene @param {Look} look @returns {KeyTable[]}
 */
export function keyTables(scene, look) {
  const { layers, keys = [] } = scene, tables = new Map(), inside = (root, path) => path.reduce((found, part) => found[part], root);
  const addKey = (title, id, key) => {
    if (!tables.has(id)) tables.set(id, { title, id, keys: [] });
    tables.get(id).keys.push({ title, id, ...key });
  };
  for (const { table, name, path, limits } of keys)
    addKey(table, table, { name, path, holder: inside({ scene, look }, path.slice(0, -1)), at: path.at(-1), limits });
  for (const [table, all_limits] of Object.entries(layers?.limits ?? {}))
    for (const [title, id, path] of tablesOfLayers(layers, table))
      for (const [name, limits] of Object.entries(all_limits))
        addKey(title, id, { name, path: [...path, name], holder: inside(layers, path), at: name, limits });
  return [...tables.values()];
}

/** Gives a scene copies of the looks that it uses: keys are set for one scene, also if others have the same look. @param {Scene} scene */
export function ownLooks({ looks }, from, to) {
  for (const [name, index] of Object.entries(looks)) looks[name] = to.push(structuredClone(from[index])) - 1;
}

/**
 * Keys that were set by hand in the scene before stay so in one that its file has made anew, unless the file has another value for them.
 * @param {Scene | undefined} before @param {Scene} scene @param {Look[]} looks
 */
export function keepKeys(before, scene, looks) {
  if (!before?.written || before.name !== scene.name) return;
  for (const { keys } of keyTables(scene, looks[scene.looks[scene.look]]))
    for (const { path, holder, at } of keys) {
      const key = path.join('.'), set = before.written.get(key);
      if (!set || JSON.stringify(holder[at]) !== set.was) continue;
      holder[at] = structuredClone(set.value);
      (scene.written ??= new Map()).set(key, set);
    }
}
