// The keys of a scene file whose values can be changed in the page.
'use strict';

// By table: its title in the scene file, and its keys, each with the object and the place there of its value, and its limits. Tables that occur
// several times in a file have titles in double brackets, and each its own id.
function keyTables(scene, look) {
  const { layers, keys = [] } = scene, tables = new Map(), inside = (root, path) => path.reduce((found, part) => found[part], root);
  const add = (title, id, key) => {
    if (!tables.has(id)) tables.set(id, { title, id, keys: [] });
    tables.get(id).keys.push({ title, id, ...key });
  };
  for (const { table, name, path, limits } of keys) add(table, table, { name, path, holder: inside({ scene, look }, path.slice(0, -1)), at: path.at(-1), limits });
  const all = kind => layers[kind].map((_, i) => [kind, i]), titles = { slabs: '[slab]', distance: '[marched]', density: '[marched]' };
  for (const [table, limits] of Object.entries(layers?.limits ?? {})) {
    const title = titles[table] ?? (table.startsWith('grade.') ? 'grade' : table);
    for (const path of titles[table] ? all(table) : table === 'sky' ? [['sky', 'smooth_disc']] : [table.split('.')])
      for (const [name, limit] of Object.entries(limits)) add(title, titles[table] ? path.join('.') : title, { name, path: [...path, name], holder: inside(layers, path), at: name, limits: limit });
  }
  return [...tables.values()];
}
