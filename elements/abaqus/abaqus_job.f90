module abaqus_job
  !! What the user elements of a job know beside the lists that they are called with. It is read once, from JOB.bezel in
  !! the folder of the job, a text (# begins a comment):
  !!
  !!     MESH       FILE=ironing.iga            operators, control points, sets (.iga, BEXT); path relative to this folder
  !!     SOLID      FIRST=1                     the mesh's elements are user elements FIRST, FIRST+1, ...
  !!     SHELL      FIRST=1                     the same, of surfaces in space
  !!     INTERFACE  FIRST=10001 SLAVE=die.bottom MASTER=slab.top PATCH=0.3 GP=2 [SIDE=-1] [REACH=0.2]
  !!                [THICKNESS=0.1]         the gap is that of the faces of shells: half the thicknesses of both
  !!
  !! A user element is a mesh element with its nodes in their order, or a facet of SLAVE with its nodes and then those of
  !! the master facets nearer than PATCH at the start, each once. Read-only after that, but for each element's own table.
  use kinds, only: wp
  use extraction_mesh, only: extraction_mesh_type, problem_list, set_of_elements, set_of_sides, &
    whole_number
  use extraction_file, only: read_extraction_file, load_text
  use text_scanner, only: scanner_type
  use number_text, only: read_number
  use surface_facets, only: facet_surface, build_surface_facets
  use master_patch, only: master_patch_type, near_facets, cut_patch
  implicit none (type, external)
  private
  public :: job_type, element_place, interface_place, read_job, solid_kind, interface_kind, shell_kind

  integer, parameter :: solid_kind = 1, interface_kind = 2, shell_kind = 3   !! JTYPE is 1000*kind + number of nodes
  integer, parameter :: most_nodes = 999                     !! that such a type can name

  type :: element_place
    !! One user element.
    integer :: kind = 0
    integer :: item = 0                          !! element of the mesh, or facet of the slave
    integer, allocatable :: nodes(:)             !! of the mesh
    real(wp), allocatable :: we(:)               !! their weights
    real(wp), allocatable :: table(:, :)         !! (:,points) what its first call precomputes
    type(master_patch_type), allocatable :: patch
    integer :: of = 0                            !! interface that it belongs to
  end type element_place

  type :: interface_place
    type(facet_surface) :: slave, master
    integer :: first = 0, gp = 0
    real(wp) :: patch = 0, reach = 0, side = 1
    real(wp) :: offset = 0                       !! distance of mid-surfaces whose shells touch [length]
  end type interface_place

  type :: job_type
    type(extraction_mesh_type) :: mesh
    integer :: ndm = 0
    integer :: first = 0                         !! number of the first solid or shell; 0: none
    integer :: bulk_kind = solid_kind            !! which of them
    type(interface_place), allocatable :: interfaces(:)
    type(element_place), allocatable :: places(:)  !! solids, then interfaces
    integer, allocatable :: range(:)             !! place before the first of each interface (number of interfaces + 1)
  contains
    procedure :: find
  end type job_type

contains

  pure integer function find(self, jelem) result(place)
    !! Index into places; 0: no such element.
    class(job_type), intent(in) :: self
    integer, intent(in) :: jelem                 !! number of a user element
    integer :: i

    place = 0
    if (self%first > 0 .and. jelem >= self%first .and. jelem < self%first + self%mesh%elements%ne) &
      place = jelem - self%first + 1
    do i = 1, size(self%interfaces)
      if (jelem < self%interfaces(i)%first) cycle
      if (jelem < self%interfaces(i)%first + self%range(i + 1) - self%range(i)) &
        place = self%range(i) + jelem - self%interfaces(i)%first + 1
    end do
  end function find

  subroutine read_job(folder, name, job, fault)
    character(*), intent(in) :: folder, name               !! of the job
    type(job_type), intent(out), target :: job
    character(:), allocatable, intent(out) :: fault        !! fact and remedy; unallocated if all is well
    type(scanner_type) :: scanner
    character(:), allocatable :: text, word, path
    type(problem_list) :: problems
    logical :: found

    path = folder//'/'//name//'.bezel'
    allocate (job%interfaces(0))
    call load_text(path, text, found)
    if (.not. found) then
      fault = 'the file '//path//' cannot be read: it names mesh and elements, MESH FILE=... and SOLID FIRST=1'
      return
    end if
    call scanner%open(text, '#')
    do
      call scanner%next_line(found)
      if (.not. found) exit
      call scanner%next_word(word)
      select case (word)
      case ('MESH')
        call option(scanner, 'FILE', word)
        if (word(1:min(1, len(word))) /= '/') word = folder//'/'//word
        call read_extraction_file(word, job%mesh, problems)
        if (problems%count > 0) then
          fault = word//', line '//whole_number(problems%list(1)%line)//': '//problems%list(1)%fact//'. '// &
            problems%list(1)%remedy
          return
        end if
        job%ndm = maxval(job%mesh%elements%dp(1:job%mesh%elements%ne))
      case ('SOLID', 'SHELL')
        job%first = nint(real_option(scanner, 'FIRST', 0.0_wp))
        job%bulk_kind = merge(shell_kind, solid_kind, word == 'SHELL')
        if (job%first < 1) then
          fault = at_line(scanner)//word//' takes FIRST=, the number of the first user element'
        else if (job%ndm == 0) then
          fault = at_line(scanner)//word//' stands behind MESH'
        else if (word == 'SHELL') then
          if (any(job%mesh%elements%dp(1:job%mesh%elements%ne) /= 2)) fault = at_line(scanner)// &
            'shells are surfaces, but the mesh has volumes: write SOLID'
          job%ndm = 3
          if (size(job%interfaces) > 0) fault = at_line(scanner)//'SHELL stands before INTERFACE'
        end if
      case ('INTERFACE')
        if (job%ndm == 0) then
          fault = at_line(scanner)//'INTERFACE stands behind MESH'
        else
          call read_interface(scanner, job, fault)
        end if
      case default
        fault = at_line(scanner)//'unknown word '//word//'. Known: MESH, SOLID, SHELL, INTERFACE'
      end select
      if (allocated(fault)) then
        fault = path//fault
        return
      end if
    end do
    if (job%ndm == 0) then
      fault = path//': there is no mesh; begin with MESH FILE=name.iga'
      return
    end if
    call make_places(job, fault)
  end subroutine read_job

  subroutine read_interface(scanner, job, fault)
    type(scanner_type), intent(inout) :: scanner
    type(job_type), intent(inout), target :: job
    character(:), allocatable, intent(out) :: fault
    type(interface_place), allocatable :: longer(:)
    character(:), allocatable :: slave, master
    integer :: n

    n = size(job%interfaces)
    allocate (longer(n + 1))
    if (n > 0) longer(1:n) = job%interfaces
    call move_alloc(longer, job%interfaces)
    call option(scanner, 'SLAVE', slave)
    call option(scanner, 'MASTER', master)
    associate (new => job%interfaces(n + 1))
      new%first = nint(real_option(scanner, 'FIRST', 0.0_wp))
      new%patch = real_option(scanner, 'PATCH', 0.0_wp)
      new%reach = real_option(scanner, 'REACH', new%patch)
      new%gp = nint(real_option(scanner, 'GP', 0.0_wp))
      new%side = real_option(scanner, 'SIDE', 1.0_wp)
      new%offset = real_option(scanner, 'THICKNESS', 0.0_wp)
      if (new%first < 1 .or. new%gp < 1 .or. .not. new%patch > 0) then
        fault = at_line(scanner)//'INTERFACE takes FIRST=number SLAVE=set MASTER=set PATCH=length GP=points'
        return
      else if (new%offset < 0) then
        fault = at_line(scanner)//'THICKNESS= is half the thicknesses of both shells, a number that is not negative'
        return
      end if
      call make_surface(job%mesh, job%ndm, slave, new%slave, fault)
      if (.not. allocated(fault)) call make_surface(job%mesh, job%ndm, master, new%master, fault)
    end associate
    if (allocated(fault)) fault = at_line(scanner)//fault
  end subroutine read_interface

  subroutine make_surface(mesh, ndm, name, surface, fault)
    !! A set of sides of solids, or of shells.
    type(extraction_mesh_type), intent(in), target :: mesh
    integer, intent(in) :: ndm                             !! space dimension
    character(*), intent(in) :: name
    type(facet_surface), intent(out) :: surface
    character(:), allocatable, intent(inout) :: fault
    character(:), allocatable :: known
    integer, allocatable :: sides(:)
    integer :: i

    known = ''
    do i = 1, size(mesh%sets)
      if (all(mesh%sets(i)%kind /= [set_of_sides, set_of_elements])) cycle
      sides = spread(0, 1, size(mesh%sets(i)%items))
      if (mesh%sets(i)%kind == set_of_sides) sides = mesh%sets(i)%sides
      if (any(mesh%elements%dp(mesh%sets(i)%items) - merge(1, 0, sides > 0) /= ndm - 1)) cycle
      known = known//' '//mesh%sets(i)%name
      if (mesh%sets(i)%name /= name) cycle
      call build_surface_facets(mesh%elements, mesh%sets(i)%items, sides, surface)
      return
    end do
    fault = 'the mesh has no surface "'//name//'". Known:'//known
  end subroutine make_surface

  subroutine make_places(job, fault)
    !! All user elements with their nodes.
    type(job_type), intent(inout), target :: job
    character(:), allocatable, intent(inout) :: fault
    integer, allocatable :: near(:)
    integer, pointer, contiguous :: nodes(:)
    integer :: e, f, i, n, place

    n = merge(job%mesh%elements%ne, 0, job%first > 0)
    allocate (job%range(size(job%interfaces) + 1))
    do i = 1, size(job%interfaces)
      job%range(i) = n
      n = n + job%interfaces(i)%slave%set%ne
    end do
    job%range(size(job%range)) = n
    allocate (job%places(n))
    do e = 1, merge(job%mesh%elements%ne, 0, job%first > 0)
      job%places(e)%kind = job%bulk_kind
      job%places(e)%item = e
      nodes => job%mesh%elements%connectivity(e)
      job%places(e)%nodes = nodes
      job%places(e)%we = job%mesh%w(nodes)
      if (size(nodes) > most_nodes) fault = 'element '//whole_number(job%first + e - 1)//' has '// &
        whole_number(size(nodes))//' nodes, more than the '//whole_number(most_nodes)//' of a user element; use lower degrees'
      if (allocated(fault)) return
    end do
    do i = 1, size(job%interfaces)
      associate (it => job%interfaces(i))
        do f = 1, it%slave%set%ne
          place = job%range(i) + f
          associate (new => job%places(place))
            new%kind = interface_kind
            new%item = f
            new%of = i
            nodes => it%slave%set%connectivity(f)
            new%nodes = nodes
            call near_facets(it%slave, f, it%master, job%mesh%x(1:job%ndm, :), it%patch, near)
            if (size(near) == 0) then
              fault = 'interface element '//whole_number(it%first + f - 1)//' has no master facet nearer than PATCH; '// &
                'increase PATCH or remove the facet from the slave surface'
              return
            end if
            allocate (new%patch)
            call cut_patch(it%master, near, job%ndm, it%reach, it%side, new%nodes, new%patch)
            new%patch%search%offset = it%offset
            new%we = job%mesh%w(new%nodes)
            if (size(new%nodes) > most_nodes) fault = 'interface element '//whole_number(it%first + f - 1)//' has '// &
              whole_number(size(new%nodes))//' nodes, more than the '//whole_number(most_nodes)//' of a user element; '// &
              'make PATCH smaller'
            if (allocated(fault)) return
          end associate
        end do
      end associate
    end do
  end subroutine make_places

  subroutine option(scanner, name, value)
    !! The text behind NAME= on this line; '' if it is not there.
    type(scanner_type), intent(in) :: scanner
    character(*), intent(in) :: name
    character(:), allocatable, intent(out) :: value
    type(scanner_type) :: here
    character(:), allocatable :: word

    value = ''
    here = scanner
    do
      call here%next_word(word)
      if (len(word) == 0) return
      if (index(word, name//'=') == 1) value = word(len(name) + 2:)
    end do
  end subroutine option

  function real_option(scanner, name, default) result(x)
    type(scanner_type), intent(in) :: scanner
    character(*), intent(in) :: name
    real(wp), intent(in) :: default
    real(wp) :: x
    character(:), allocatable :: value
    integer :: used

    call option(scanner, name, value)
    x = default
    if (len(value) == 0) return
    call read_number(value, x, used)
    if (used /= len(value)) x = -1
  end function real_option

  function at_line(scanner) result(text)
    type(scanner_type), intent(in) :: scanner
    character(:), allocatable :: text

    text = ', line '//whole_number(scanner%line)//': '
  end function at_line
end module abaqus_job
