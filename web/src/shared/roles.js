// The kinds of views, in the order in which they are listed.
export const ROLES = {
  train: {name: 'Training', plural: 'Training views', color: '#7cc4ff', image: 'Photo'},
  test: {name: 'Test', plural: 'Test views', color: '#e58fc0', image: 'Photo'},
  proposal: {name: 'Invented view', plural: 'Invented views', color: '#ffb000', image: 'Invented view'},
};

// The images of a view, as {key, label, url}; only those that there are.
export function imagesOf(view) {
  const all = [
    ['image', ROLES[view.role]?.image ?? 'Image'], ['render', 'Render'], ['error', 'Error map'],
    ['uncertainty', 'Expected error'], ['confidence', 'Trust'], ['support', 'Support map']];
  return all.filter(([key]) => view[key]?.url).map(([key, label]) => ({key, label, url: view[key].url}));
}
